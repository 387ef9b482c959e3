// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include <rths/controller/target_force.hpp>
#include <rths/core/error.hpp>

#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using Eigen::Vector2d;
using test::kPeriod;

constexpr int kTicksPerTarget = 10;

/// An orbit of two frequencies: displacement and its derivatives. [m], [m/s], [m/s²]
Vector2d orbit(double t, int derivative) {
  constexpr double kSlow = 2 * std::numbers::pi * 0.5, kFast = 2 * std::numbers::pi * 0.8;
  const double quarter = derivative * std::numbers::pi / 2;
  return {0.08 * std::pow(kSlow, derivative) * std::sin(kSlow * t + quarter),
          0.05 * std::pow(kFast, derivative) * std::sin(kFast * t + 1 + quarter)};
}

/// A specimen of one slider and a spring.
struct Specimen {
  double strength = 1e6, reach = 3e-3, stiffness = 4e6;
  Sliders slider{{3e-3}, {}, 2};
  Vector2d at = Vector2d::Zero(), force = Vector2d::Zero();
  Vector2d move(const Vector2d& to) {
    slider.move(to - at);
    at = to;
    return force = strength * slider.states().col(0) + stiffness * to;
  }
};

/// Root mean square of an error and of the error without correction, at the targets [N].
struct Errors {
  double corrected = 0, uncorrected = 0;
};

/// Sums up such errors at the targets from 5 s on.
class ErrorSum {
 public:
  void add(int tick, const TargetForce& force, const Vector2d& measured, const Vector2d& wanted) {
    if (tick % kTicksPerTarget != 0 || tick * kPeriod < 5) return;
    corrected_ += (measured + force.correction() - wanted).squaredNorm();
    uncorrected_ += (measured - wanted).squaredNorm();
    ++count_;
  }
  [[nodiscard]] Errors rms() const {
    return {std::sqrt(corrected_ / count_), std::sqrt(uncorrected_ / count_)};
  }

 private:
  double corrected_ = 0, uncorrected_ = 0;
  int count_ = 0;
};

/// The tick of the target that is under way.
int target_of(int tick) { return (tick + kTicksPerTarget - 1) / kTicksPerTarget * kTicksPerTarget; }

/// A machine that is late moves a specimen. Errors of the force at the targets from 5 s on.
Errors errors_of(double delay, double noise, const TargetForceSettings& settings = {}) {
  TargetForce force{settings};
  Specimen real, wanted;
  std::mt19937_64 random{7};
  std::normal_distribution<double> normal{0, noise};
  ErrorSum errors;
  // Both start at the target, without force.
  real.at = wanted.at = orbit(0, 0);
  for (int tick = 0; tick < 12'000; ++tick) {
    const double t = tick * kPeriod;
    const Vector2d measured_force = real.move(orbit(t - delay, 0));
    wanted.move(orbit(t, 0));
    const Vector2d target = orbit(target_of(tick) * kPeriod, 0);
    const Vector2d displacement =
        orbit(t - delay, 0) + 5e-5 * Vector2d{normal(random), normal(random)};
    const Vector2d acceleration =
        orbit(t - delay, 2) + 0.05 * Vector2d{normal(random), normal(random)};
    const Vector2d fed = measured_force + 8e3 * Vector2d{normal(random), normal(random)};
    force.step({target.data(), displacement.data(), acceleration.data(), fed.data()}, true);
    errors.add(tick, force, measured_force, wanted.force);
  }
  return errors.rms();
}

// With the true reach among the sliders, the model is exact; the way between targets is not.
TEST(TargetForce, OfALateMachineIsThatAtTheTarget) {
  TargetForceSettings settings;
  settings.reach = {3e-3, 1.0};
  settings.smooth_reach = {};
  const Errors found = errors_of(0.005, 0, settings);

  EXPECT_GT(found.uncorrected, 25e3);
  EXPECT_LT(found.corrected, 0.01 * found.uncorrected);
}

TEST(TargetForce, NeedsNoSliderOfTheSpecimensReach) {
  TargetForceSettings settings;
  settings.reach = {1e-3, 2e-3, 4e-3, 8e-3, 1.0};
  settings.smooth_reach = {};
  const Errors found = errors_of(0.005, 1, settings);

  EXPECT_LT(found.corrected, 0.4 * found.uncorrected);
}

// Sensor noise passes through the steepest slider: (Q/r) times the noise of the fused displacement,
// about a quarter of the sensor's 50 µm, is 4 kN. A machine that is 5 ms late errs by 29 kN.
TEST(TargetForce, AddsLittleNoiseToAnExactMachine) {
  TargetForceSettings settings;
  settings.reach = {1e-3, 3e-3, 9e-3, 1.0};
  settings.smooth_reach = {};

  EXPECT_LT(errors_of(0, 1, settings).corrected, 10e3);
}

TEST(TargetForce, IsTheMeasuredForceUntilTheMotionInforms) {
  TargetForce force{{}};
  for (int tick = 0; tick < 2000; ++tick) {
    const Vector2d slow = Vector2d::Constant(1e-6 * tick), none = Vector2d::Zero(),
                   late = slow - Vector2d::Constant(1e-3), pull = 1e8 * slow;
    force.step({slow.data(), late.data(), none.data(), pull.data()}, true);
    ASSERT_EQ(force.correction().norm(), 0);
    ASSERT_FALSE(force.learning());
  }
}

// The first step of a motion, when nothing is learnt: the expected stiffness times the error.
TEST(TargetForce, KnowsTheExpectedStiffnessFromTheStart) {
  TargetForceSettings settings;
  settings.reach = {1};
  settings.smooth_reach = {3e-3};
  settings.expected = {4e6, 1e6};
  TargetForce force{settings};
  const Vector2d zero = Vector2d::Zero(), target{1e-7, 0};
  force.step({zero.data(), zero.data(), zero.data(), zero.data()}, true);
  force.step({target.data(), zero.data(), zero.data(), zero.data()}, true);

  EXPECT_EQ(force.strengths(), Eigen::Vector2d(4e6, 1e6));
  EXPECT_NEAR(force.correction()[0], 1e-7 * (4e6 + 1e6 / 3e-3), 1e-3);
}

TEST(TargetForce, OfASpringIsStiffnessTimesError) {
  TargetForceSettings settings;
  settings.reach = {1.0};
  settings.smooth_reach = {};
  TargetForce force{settings};
  const double stiffness = 4e6;
  double largest = 0;
  for (int tick = 0; tick < 8000; ++tick) {
    const double t = tick * kPeriod;
    const Vector2d target = orbit(t, 0), measured = 0.98 * target, rate = 0.98 * orbit(t, 2),
                   fed = stiffness * measured;
    force.step({target.data(), measured.data(), rate.data(), fed.data()}, true);
    if (t < 4) continue;
    const Vector2d expected = stiffness * 0.02 * target;
    largest = std::max(largest, (force.correction() - expected).norm());
  }

  // 1 % of the largest correction: the ridge of the fit and the fused motion
  EXPECT_LT(largest, 0.01 * stiffness * 0.02 * 0.08);
}

TEST(TargetForce, StaysWithinTwiceTheLearntStrength) {
  TargetForceSettings settings;
  settings.reach = {1e-3, 3e-3};
  TargetForce force{settings};
  Specimen real;
  for (int tick = 0; tick < 10'000; ++tick) {
    const double t = tick * kPeriod;
    const Vector2d there = orbit(t, 0), rate = orbit(t, 2), fed = real.move(there);
    // From 6 s on the sensor sticks.
    const Vector2d found = t < 6 ? there : orbit(6, 0), none = Vector2d::Zero();
    force.step({there.data(), found.data(), t < 6 ? rate.data() : none.data(), fed.data()}, true);
    ASSERT_LE(force.correction().norm(), 2 * force.strengths().sum() + 1e-6);
  }
}

TEST(TargetForce, HoldsTheLastSampleThatIsANumber) {
  TargetForce force{{}};
  const Vector2d target{0.01, 0}, zero = Vector2d::Zero(),
                                  bad{std::numeric_limits<double>::quiet_NaN(), 0};
  force.step({target.data(), zero.data(), zero.data(), zero.data()}, true);
  force.step({bad.data(), bad.data(), zero.data(), zero.data()}, true);
  force.step({target.data(), zero.data(), zero.data(), bad.data()}, true);

  EXPECT_EQ(force.bad_samples(), 3 - 1);
  EXPECT_TRUE(force.correction().allFinite());
}

/// An exact machine on the orbit, and the force of its specimen now and one lead time later.
/// A flat slider with a spring: its friction depends on load and velocity, its stiffness before
/// sliding on neither.
class FlatSlider final : public SpecimenModel {
 public:
  explicit FlatSlider(double friction) : friction_{friction} {}
  const Eigen::VectorXd& move(const Eigen::VectorXd& displacement, const Eigen::VectorXd& velocity,
                              double axial_load) noexcept override {
    const double load = std::isfinite(axial_load) ? axial_load : kLoadAtRest;
    const double yield = friction_ * load * (1 - 0.5 * std::exp(-50 * velocity.norm()));
    elastic_ += kStiffness * (displacement - at_);
    elastic_ *= std::min(1.0, yield / std::max(elastic_.norm(), 1.0));
    at_ = displacement;
    return force_ = elastic_ + kSpring * displacement;
  }
  static constexpr double kLoadAtRest = 10e6, kStiffness = 1e9, kSpring = 4e6;  // [N], [N/m]

 private:
  double friction_;
  Eigen::VectorXd at_ = Vector2d::Zero(), elastic_ = at_, force_ = at_;
};

/// The first axis of the orbit, from its start.
Vector2d line(double t, int derivative) {
  const double start = derivative == 0 ? orbit(0, 0)[0] : 0;
  return {orbit(t, derivative)[0] - start, 0};
}

TargetForceSettings assuming(const MakeSpecimen& specimen) {
  TargetForceSettings settings;
  settings.specimen = specimen;
  return settings;
}

/// The same of a flat slider and a machine that is 5 ms late, along one axis: the motion stops at
/// each reversal.
Errors errors_of_a_slider(double friction, const TargetForceSettings& settings) {
  TargetForce force{settings};
  FlatSlider real{friction}, wanted{friction};
  ErrorSum errors;
  const auto moved = [](FlatSlider& slider, double t) -> Vector2d {
    const Eigen::VectorXd x = line(t, 0), v = line(t, 1);
    return slider.move(x, v, FlatSlider::kLoadAtRest);
  };
  for (int tick = 0; tick < 12'000; ++tick) {
    const double t = tick * kPeriod, late = std::max(0.0, t - 0.005);
    const Vector2d fed = moved(real, late), there = moved(wanted, t);
    const Vector2d target = line(target_of(tick) * kPeriod, 0), x = line(late, 0),
                   a = line(late, 2);
    force.step({target.data(), x.data(), a.data(), fed.data()}, true);
    errors.add(tick, force, fed, there);
  }
  return errors.rms();
}

// The assumed friction is a tenth too low. A slider of the assumed reach knows no velocity.
TEST(TargetForce, FollowsTheAssumedSpecimenMuchCloserThanASlider) {
  TargetForceSettings slider;
  slider.reach = {1e-3, 1.0};
  slider.smooth_reach = {};
  const Errors by_slider = errors_of_a_slider(0.11, slider);
  const Errors found =
      errors_of_a_slider(0.11, assuming([] { return std::make_unique<FlatSlider>(0.10); }));

  EXPECT_LT(found.corrected, 0.2 * found.uncorrected);
  EXPECT_LT(found.corrected, 0.5 * by_slider.corrected);
}

TEST(TargetForce, KnowsTheStiffnessOfTheAssumedSpecimenFromTheStart) {
  TargetForce force{assuming([] { return std::make_unique<FlatSlider>(0.1); })};
  const Vector2d zero = Vector2d::Zero(), target{1e-7, 0};
  force.step({zero.data(), zero.data(), zero.data(), zero.data()}, true);
  force.step({target.data(), zero.data(), zero.data(), zero.data()}, true);

  EXPECT_NEAR(force.correction()[0], 1e-7 * (FlatSlider::kStiffness + FlatSlider::kSpring), 1e-3);
}

// Where both friction and motion are large, the correction is twice the friction at this load.
TEST(TargetForce, OfAnAssumedSpecimenHasTheMeasuredLoad) {
  const auto correction_under = [](double load) {
    TargetForce force{assuming([] { return std::make_unique<FlatSlider>(0.1); })};
    const Vector2d zero = Vector2d::Zero(), target{0.02, 0};
    for (const Vector2d* wanted : {&zero, &target})
      force.step(
          {wanted->data(), zero.data(), zero.data(), zero.data(), nullptr, nullptr, nullptr, load},
          true);
    return force.correction()[0];
  };
  const double spring = 0.02 * FlatSlider::kSpring;

  EXPECT_NEAR(correction_under(5e6) - spring, 0.1 * 5e6, 1e3);
  EXPECT_NEAR(correction_under(std::numeric_limits<double>::quiet_NaN()) - spring, 0.1 * 10e6, 1e3);
}

struct LeadingRun {
  TargetForce force;
  Specimen now, later;
  double lead;
  double apart = 0, moved = 0;  ///< sums of squares of errors of the force ahead, and without lead
  explicit LeadingRun(double lead_time)
      : force{[&] {
          TargetForceSettings settings;
          settings.reach = {3e-3, 1.0};
          settings.smooth_reach = {};
          settings.lead_time = lead_time;
          return settings;
        }()},
        lead{lead_time} {
    now.at = later.at = orbit(0, 0);
  }
  void run(int from, int to) {
    for (int tick = from; tick < to; ++tick) {
      const double t = tick * kPeriod;
      const Vector2d x = orbit(t, 0), v = orbit(t, 1), a = orbit(t, 2), fed = now.move(x);
      later.move(orbit(t + lead, 0));
      force.step({x.data(), x.data(), a.data(), fed.data(), x.data(), v.data(), a.data()}, true);
      apart += (force.ahead() - later.force).squaredNorm();
      moved += (fed - later.force).squaredNorm();
    }
  }
};

// The third derivative, at most 8 m/s³, is left out: 8 · 0.015³/6 = 5 µm on 3.3·10⁸ N/m is 1.5 kN.
// The force moves by 100 kN/s · 15 ms and, at reversals, by some hundred kN.
TEST(TargetForce, AheadIsTheForceOneLeadTimeLater) {
  LeadingRun run{0.015};
  run.run(0, 5'000);
  run.apart = run.moved = 0;

  run.run(5'000, 12'000);

  EXPECT_LT(std::sqrt(run.apart / 7'000), 5e3);
  EXPECT_GT(std::sqrt(run.moved / 7'000), 50e3);
}

TEST(TargetForce, StartsAtTheFirstTargetThatIsANumber) {
  LeadingRun run{0.015}, late{0.015};
  const Vector2d bad{std::numeric_limits<double>::quiet_NaN(), 0}, zero = Vector2d::Zero();
  late.force.step(
      {bad.data(), zero.data(), zero.data(), zero.data(), bad.data(), zero.data(), zero.data()},
      true);

  run.run(0, 3'000);
  late.run(0, 3'000);

  EXPECT_EQ(late.force.bad_samples(), 1);
  EXPECT_GT(run.force.ahead().norm(), 1e3);
  EXPECT_EQ(late.force.ahead(), run.force.ahead());
  EXPECT_EQ(late.force.correction(), run.force.correction());
}

TEST(TargetForce, AheadIsZeroWithoutALeadTimeOrACommand) {
  LeadingRun none{0};
  none.run(0, 3'000);
  TargetForceSettings settings;
  settings.lead_time = 0.015;
  settings.reach = {1};
  settings.smooth_reach = {2.5e-3};
  settings.expected = {0, 1e6};
  TargetForce without{settings};
  const Vector2d at{0.01, 0}, zero = Vector2d::Zero();
  without.step({at.data(), at.data(), zero.data(), zero.data()}, true);

  EXPECT_TRUE(none.force.ahead().isZero(0));
  EXPECT_TRUE(without.ahead().isZero(0));
}

TEST(TargetForce, AheadIsHeldWhileTheCommandIsNotANumber) {
  LeadingRun run{0.015};
  run.run(0, 5'000);
  const Eigen::VectorXd last = run.force.ahead();
  const Vector2d x = orbit(5, 0), zero = Vector2d::Zero();
  const Vector2d bad{std::numeric_limits<double>::quiet_NaN(), 0};

  run.force.step({x.data(), x.data(), zero.data(), zero.data(), x.data(), bad.data(), zero.data()},
                 false);

  EXPECT_EQ((run.force.ahead() - last).norm(), 0);
}

TEST(TargetForce, IsFitForRealTime) {
  TargetForce force{{}};
  const Vector2d zero = Vector2d::Zero();
  for (int tick = 0; tick < 500; ++tick) {
    const Vector2d at = orbit(tick * kPeriod, 0), fed = 1e6 * at;
    EXPECT_REALTIME(force.step(
        {at.data(), at.data(), zero.data(), fed.data(), at.data(), zero.data(), zero.data()},
        true));
  }
  EXPECT_TRUE(force.learning());
}

TEST(TargetForce, OfAnAssumedSpecimenIsFitForRealTime) {
  TargetForceSettings settings = assuming([] { return std::make_unique<FlatSlider>(0.1); });
  settings.lead_time = 0.015;
  TargetForce force{settings};
  const Vector2d zero = Vector2d::Zero();
  for (int tick = 0; tick < 500; ++tick) {
    const Vector2d at = orbit(tick * kPeriod, 0), fed = 1e6 * at;
    EXPECT_REALTIME(force.step(
        {at.data(), at.data(), zero.data(), fed.data(), at.data(), zero.data(), zero.data()},
        true));
  }
  EXPECT_GT(force.ahead().norm(), 0);
}

TEST(TargetForce, RefusesASpecimenWithoutForce) {
  struct Nothing final : SpecimenModel {
    const Eigen::VectorXd& move(const Eigen::VectorXd&, const Eigen::VectorXd&,
                                double) noexcept override {
      return none;
    }
    Eigen::VectorXd none = Vector2d::Zero();
  };

  EXPECT_EQ(
      test::error_of([&] { TargetForce{assuming([] { return std::make_unique<Nothing>(); })}; }),
      "force at the target: force of the assumed specimen is 0, expected a positive one [N] "
      "after a move of 150 mm");
}

TEST(TargetForce, RefusesWrongSettings) {
  TargetForceSettings none, negative, tiny, short_memory, half, weak, late;
  late.lead_time = -1;
  none.reach = {};
  negative.reach = {1e-3, -1e-3};
  tiny.smooth_reach = {1e-310, 1e-3};
  short_memory.forgetting = 0;
  half.expected = {1e6};
  weak.expected = std::vector<double>(15, -1);

  EXPECT_EQ(test::error_of([&] { TargetForce{none}; }),
            "force at the target: number of sliders is 0, expected at least 1");
  EXPECT_EQ(test::error_of([&] { TargetForce{negative}; }),
            "force at the target: reach of a slider is -0.001, expected 1e-6 to 10 m");
  EXPECT_EQ(test::error_of([&] { TargetForce{tiny}; }),
            "force at the target: reach of a slider is 1e-310, expected 1e-6 to 10 m");
  EXPECT_EQ(test::error_of([&] { TargetForce{short_memory}; }),
            "force at the target: forgetting is 0, expected more than a period");
  EXPECT_EQ(test::error_of([&] { TargetForce{late}; }),
            "force at the target: lead time is -1, expected at least 0 s");
  EXPECT_EQ(test::error_of([&] { TargetForce{half}; }),
            "force at the target: number of expected strengths is 1, expected one of each slider");
  EXPECT_EQ(test::error_of([&] { TargetForce{weak}; }),
            "force at the target: expected strength is -1, expected at least 0 N");
}

TEST(Sliders, FollowTheMasingRuleInOneDirection) {
  Sliders sliders{{2e-3}, {}, 2};
  const auto move = [&](double x) { sliders.move(Vector2d{x, 0}); };

  move(1e-3);
  EXPECT_DOUBLE_EQ(sliders.states()(0, 0), 0.5);
  move(5e-3);
  EXPECT_DOUBLE_EQ(sliders.states()(0, 0), 1);
  move(-2e-3);
  EXPECT_NEAR(sliders.states()(0, 0), 0, 1e-15);
  move(-9e-3);
  EXPECT_DOUBLE_EQ(sliders.states()(0, 0), -1);
}

// Its differential equation in small steps: Park, Wen and Ang (1986) with β = γ.
TEST(Sliders, SmoothOnesSolveTheirEquation) {
  constexpr double kReach = 2e-3;
  Sliders sliders{{}, {kReach}, 2};
  Vector2d fine = Vector2d::Zero();
  const auto move = [&](const Vector2d& step) {
    sliders.move(step);
    constexpr int kPieces = 200'000;
    for (int i = 0; i < kPieces; ++i) {
      const Vector2d d = step / kReach / kPieces;
      fine += d - fine * std::max(0.0, fine.dot(d));
    }
    const Vector2d found = sliders.states().col(0);
    EXPECT_LT((found - fine).norm(), 1e-4) << step.transpose();
    EXPECT_LE(found.norm(), 1);
  };

  move({1e-3, 0});
  move({3e-3, 2e-3});
  move({-1e-3, 4e-3});
  move({0, -9e-3});  // unloads and yields again in one step
  move({0.1, 0});
}

}  // namespace
}  // namespace rths::controller
