// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <deque>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <rths/controller/ats.hpp>
#include <rths/controller/feed_forward.hpp>
#include <rths/maths/decompositions.hpp>
#include <rths/maths/low_pass.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

/// Band-limited motion with its exact rates.
struct BandLimitedMotion {
  [[nodiscard]] double at(double t) const { return sum(t, 0); }
  [[nodiscard]] double rate(double t) const { return sum(t, 1); }
  [[nodiscard]] double second_rate(double t) const { return sum(t, 2); }

 private:
  [[nodiscard]] static double sum(double t, int derivative) {
    constexpr double kFrequency[] = {0.4, 0.9, 1.7};
    constexpr double kAmplitude[] = {0.10, 0.05, 0.02};
    double total = 0;
    for (int i = 0; i < 3; ++i) {
      const double w = 2 * std::numbers::pi * kFrequency[i];
      total += kAmplitude[i] * std::pow(w, derivative) *
               std::sin(w * t + i + derivative * std::numbers::pi / 2);
    }
    return total;
  }
};

/// A machine with a pure delay.
class PureDelay {
 public:
  explicit PureDelay(int samples) : line_(static_cast<std::size_t>(samples), 0.0) {}
  double operator()(double reference) {
    line_.push_back(reference);
    const double out = line_.front();
    line_.pop_front();
    return out;
  }

 private:
  std::deque<double> line_;
};

struct Outcome {
  Eigen::Vector3d coefficients;
  double worst_error;  ///< of the last five seconds [m]
};

Outcome follow(Ats& ats, PureDelay machine, double duration) {
  const BandLimitedMotion motion;
  double measured = 0;
  double worst = 0;
  for (int i = 0; i * kPeriod < duration; ++i) {
    const double t = i * kPeriod;
    const double reference =
        ats.step({motion.at(t), motion.rate(t), motion.second_rate(t)}, measured, 1, true);
    measured = machine(reference);
    if (t > duration - 5) worst = std::max(worst, std::abs(measured - motion.at(t + kPeriod)));
  }
  return {ats.coefficients(), worst};
}

AtsSettings settings_with_initial_delay(double tau) {
  AtsSettings settings;
  settings.period = kPeriod;
  settings.initial = {1, tau, tau * tau / 2};
  return settings;
}

// A pure delay τ has the series 1, τ, τ²/2. The residual is its third-order term, τ³ω³/6 at 1.7 Hz.
TEST(Ats, FindsTheDelayOfAPureDelay) {
  Ats ats{settings_with_initial_delay(0.020)};

  const Outcome outcome = follow(ats, PureDelay{39}, 20);

  // 39 samples in the line and one until the feedback is read: 40 ms. The series is truncated after
  // the second order, so the fit is off by terms of the third order.
  EXPECT_NEAR(outcome.coefficients[0], 1, 0.03);
  EXPECT_NEAR(outcome.coefficients[1], 0.040, 0.002);
  EXPECT_NEAR(outcome.coefficients[2], 0.0008, 0.0003);
  const double left_out = std::pow(0.040 * 2 * std::numbers::pi * 1.7, 3) / 6 * 0.02;
  EXPECT_LT(outcome.worst_error, 5 * left_out + 1e-4);
}

// Solves the same least-squares problem directly from all samples of the window.
TEST(Ats, FitsTheWindowAsADirectLeastSquaresDoes) {
  auto settings = settings_with_initial_delay(0.030);
  settings.largest_change = {1e9, 1e9, 1e9};
  settings.lowest = {-1e9, -1e9, -1e9};
  settings.highest = {1e9, 1e9, 1e9};
  Ats ats{settings};
  maths::LowPass command_filter{6, 20, kPeriod};
  maths::LowPass response_filter{6, 20, kPeriod};
  PureDelay machine{30};
  const BandLimitedMotion motion;
  std::vector<Eigen::Vector4d> rows;  // x_m, its two differences, u_f
  double measured = 0;
  double previous = 0;
  double previous_difference = 0;
  for (int i = 0; i < 5000; ++i) {
    const double t = i * kPeriod;
    // Without smoothing the reference sent is the one fitted.
    const double reference =
        ats.step({motion.at(t), motion.rate(t), motion.second_rate(t)}, measured, 1, true);
    const double response = response_filter(measured);
    const double difference = (response - previous) / kPeriod;
    rows.push_back({response, difference, (difference - previous_difference) / kPeriod,
                    command_filter(reference)});
    previous_difference = difference;
    previous = response;
    measured = machine(reference);
  }

  // The step before the last completed the set that the last step fitted.
  Eigen::MatrixXd X(62, 3);
  Eigen::VectorXd u(62);
  for (int k = 0; k < 62; ++k) {
    const Eigen::Vector4d& row = rows[rows.size() - 2 - 16 * static_cast<std::size_t>(k)];
    X.row(k) = row.head<3>();
    u[k] = row[3];
  }
  const Eigen::Vector3d direct = maths::solve_least_squares(X, u);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(ats.coefficients()[i], direct[i], 1e-6 * std::abs(direct[i]));
}

TEST(Ats, CompensatesForTheDelayOfItsOwnSmoothing) {
  auto settings = settings_with_initial_delay(0.020);
  settings.smoothing = 11;  // five samples of delay
  Ats ats{settings};

  const Outcome outcome = follow(ats, PureDelay{39}, 20);

  EXPECT_NEAR(outcome.coefficients[1], 0.045, 0.002);
}

// One lost sample in ten seconds changes the fit of its window only.
TEST(Ats, HoldsTheLastSampleThatIsANumber) {
  Ats ats{settings_with_initial_delay(0.020)};
  const double bad = std::numeric_limits<double>::quiet_NaN();
  static_cast<void>(follow(ats, PureDelay{39}, 10));

  EXPECT_TRUE(std::isfinite(ats.step({0.01, 0, 0}, bad, 1, true)));
  EXPECT_TRUE(std::isfinite(ats.step({bad, 0, 0}, 0.01, 1, true)));

  EXPECT_NEAR(follow(ats, PureDelay{39}, 10).coefficients[1], 0.040, 0.002);
}

TEST(Ats, KeepsItsInitialCoefficientsBelowTheThreshold) {
  Ats ats{settings_with_initial_delay(0.025)};

  for (int i = 0; i < 3000; ++i)
    static_cast<void>(
        ats.step({1e-4 * std::sin(0.01 * i), 0, 0}, 1e-4 * std::sin(0.01 * i), 1, true));

  EXPECT_EQ(ats.coefficients()[1], 0.025);
}

TEST(Ats, KeepsItsCoefficientsWhenAdaptationIsOff) {
  Ats ats{settings_with_initial_delay(0.025)};
  const BandLimitedMotion motion;

  for (int i = 0; i < 5000; ++i)
    static_cast<void>(
        ats.step({motion.at(i * kPeriod), 0, 0}, motion.at(i * kPeriod - 0.06), 1, false));

  EXPECT_EQ(ats.coefficients()[1], 0.025);
}

TEST(Ats, KeepsCoefficientsInTheirRange) {
  Ats ats{settings_with_initial_delay(0.040)};
  std::mt19937 random{3};
  std::normal_distribution<double> noise{0, 0.05};

  for (int i = 0; i < 5000; ++i) {
    static_cast<void>(
        ats.step({noise(random), noise(random), noise(random)}, noise(random), 1, true));
    const Eigen::Vector3d& a = ats.coefficients();
    ASSERT_TRUE(a.allFinite());
    ASSERT_GE(a[0], 0.7);
    ASSERT_LE(a[0], 1.3);
    ASSERT_GE(a[1], 0);
    ASSERT_LE(a[1], 0.08);
    ASSERT_GE(a[2], 0);
    ASSERT_LE(a[2], 0.0032);
  }
  EXPECT_GT(ats.limited(), 0);
}

TEST(Ats, LimitsTheChangePerSample) {
  auto settings = settings_with_initial_delay(0.020);
  settings.largest_change = {0.001, 1e-5, 1e-6};
  Ats ats{settings};
  const BandLimitedMotion motion;
  PureDelay machine{60};
  double measured = 0;
  Eigen::Vector3d before = ats.coefficients();
  for (int i = 0; i < 8000; ++i) {
    const double t = i * kPeriod;
    measured =
        machine(ats.step({motion.at(t), motion.rate(t), motion.second_rate(t)}, measured, 1, true));
    const Eigen::Vector3d change = (ats.coefficients() - before).cwiseAbs();
    ASSERT_TRUE((change.array() <= settings.largest_change.array() + 1e-15).all());
    before = ats.coefficients();
  }
}

// A specimen at rest gives noise without information, from which a fit would make a1 collapse.
TEST(Ats, FreezesItsCoefficientsWhileTheMachineRests) {
  auto settings = settings_with_initial_delay(0.020);
  settings.quiet_rms = 1e-3;
  Ats ats{settings};
  static_cast<void>(follow(ats, PureDelay{39}, 20));
  const double learnt = ats.coefficients()[1];
  std::mt19937 random{5};
  std::normal_distribution<double> noise{0, 5e-5};

  // The motion ends; one window later only sensor noise remains.
  for (int i = 0; i < 1100; ++i) static_cast<void>(ats.step({0, 0, 0}, noise(random), 1, false));
  for (int i = 0; i < 10'000; ++i) static_cast<void>(ats.step({0, 0, 0}, noise(random), 1, true));

  EXPECT_EQ(ats.coefficients()[1], learnt);
}

TEST(Ats, RefusesSettingsThatCannotWork) {
  AtsSettings short_window;
  short_window.window = 0.01;
  AtsSettings crossed;
  crossed.lowest[1] = 1;

  EXPECT_NE(test::error_of([&] { Ats{short_window}; }), "");
  EXPECT_NE(test::error_of([&] { Ats{crossed}; }), "");
}

// While the lead is off, the fit uses the command sent. So the coefficients do not wind up and are
// right when the lead is switched on.
TEST(Ats, AdaptsToTheMachineWhileItIsSwitchedOff) {
  Ats ats{settings_with_initial_delay(0.020)};
  PureDelay machine{39};
  const BandLimitedMotion motion;
  double measured = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double t = i * kPeriod;
    const Eigen::Vector3d command{motion.at(t), motion.rate(t), motion.second_rate(t)};
    const double reference = ats.step(command, measured, 0, true);
    EXPECT_EQ(reference, command[0]);
    measured = machine(reference);
  }

  EXPECT_NEAR(ats.coefficients()[0], 1, 0.03);
  EXPECT_NEAR(ats.coefficients()[1], 0.040, 0.002);
  EXPECT_LT(ats.limited(), 1000);  // while the window fills
}

TEST(Ats, StepsInRealTime) {
  Ats ats{AtsSettings{}};
  const BandLimitedMotion motion;
  double reference = 0;
  for (int i = 0; i < 1500; ++i) {
    const double t = i * kPeriod;
    EXPECT_REALTIME(reference = ats.step({motion.at(t), motion.rate(t), motion.second_rate(t)},
                                         motion.at(t - 0.05), 1, true));
  }
  EXPECT_TRUE(std::isfinite(reference));
}

TEST(FeedForward, LeadsByItsGainTimesTheRate) {
  const FeedForward lead{0.03, 0.0004};

  EXPECT_DOUBLE_EQ(lead(0.1, 2, -5), 0.1 + 0.06 - 0.002);
}

TEST(FeedForward, WorksInRealTime) {
  const FeedForward lead{0.03, 0.0004};
  double reference = 0;
  EXPECT_REALTIME(reference = lead(0.1, 2, -5));
  EXPECT_GT(reference, 0);
}

}  // namespace
}  // namespace rths::controller
