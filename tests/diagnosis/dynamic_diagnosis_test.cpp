// SPDX-License-Identifier: Apache-2.0
// User-defined systems, described in case.toml alone, with an effect that the model leaves out.
// Recordings come from an integrator that shares no code with the library.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/verdict/diagnose.hpp>

#include "dynamic_truth.hpp"
#include "support/long_run.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test_support::Truth;

constexpr double kStep = 0.005;
constexpr std::size_t kRest = 400;
constexpr double kPush = 20;      // root mean square [N]
constexpr double kNoise = 0.003;  // of the root mean square of an output
constexpr const char* kFiles[] = {"fit.csv", "second.csv", "third.csv"};

double clipped(double x, double limit) { return std::clamp(x, -limit, limit); }

// An effect left out of the model, and its accepted names: "name at channel".
struct LeftOut {
  std::string effect;
  std::vector<std::string> names;
  std::function<void(Truth&)> in_system;
  std::function<void(Eigen::Ref<VectorXd>, double rms)> in_first_output = {};
};

void PrintTo(const LeftOut& left_out, std::ostream* out) { *out << left_out.effect; }
std::string name_of(const ::testing::TestParamInfo<LeftOut>& info) { return info.param.effect; }

// A first-order lag of the smooth signal: cubic between the two samples before and after.
void lagging(Eigen::Ref<VectorXd> y, double) {
  constexpr double kTimeConstant = 0.015;
  constexpr int kSubsteps = 50;
  const VectorXd x = y;
  const auto at = [&](Index k) { return x[std::clamp<Index>(k, 0, x.size() - 1)]; };
  double behind = x[0];
  for (Index k = 1; k < x.size(); ++k) {
    for (int i = 1; i <= kSubsteps; ++i) {
      const double s = static_cast<double>(i) / kSubsteps, a = s + 1, b = s - 1, c = s - 2;
      const double now = (-s * b * c * at(k - 2) + a * s * b * at(k + 1)) / 6 +
                         (a * b * c * at(k - 1) - a * s * c * at(k)) / 2;
      behind += (now - behind) * -std::expm1(-kStep / kSubsteps / kTimeConstant);
    }
    y[k] = behind;
  }
}

void saturate(Truth& truth) {
  truth.input = [](const auto& u, double t) { return clipped(u(t), 1.6 * kPush); };
}
void leave_dead_zone(Truth& truth) {
  truth.input = [](const auto& u, double t) { return u(t) - clipped(u(t), 0.2 * kPush); };
}
void lose_signs(Truth& truth) {
  truth.input = [](const auto& u, double t) { return 0.7 * u(t) + 0.3 * std::abs(u(t)); };
}
void delay(Truth& truth) {
  truth.input = [](const auto& u, double t) { return u(t - 0.012); };
}
void soften(Truth& truth) {
  truth.spring = [](Index i, double d, double) { return i == 0 ? -5e5 * d * d * d : 0; };
}
// Only the spring has play.
void loosen(Truth& truth) {
  truth.hysteretic = 0;
  truth.gap = 1e-3;
  truth.spring = [c = truth.damping[0]](Index i, double, double v) { return i == 0 ? c * v : 0; };
  truth.damping[0] = 0;
}
void rub(Truth& truth) {
  truth.gain = 3;
  truth.memory_rate = [](double s, double v) { return (v - s * std::abs(v)) / 2e-4; };
}
// At one place of the stroke.
void rub_locally(Truth& truth) {
  rub(truth);
  truth.gain = 6;
  truth.grip = [](double d) { return std::exp(-std::pow((d - 3e-3) / 3e-3, 2)); };
}

void saturated(Eigen::Ref<VectorXd> y, double rms) {
  y = y.cwiseMin(1.3 * rms).cwiseMax(-1.3 * rms);
}
void wrap(Eigen::Ref<VectorXd> y, double limit) {
  for (double& value : y) value -= 2 * limit * std::round(value / (2 * limit));
}
constexpr double kOverflow = 1.8;  // of the rms
void overflown(Eigen::Ref<VectorXd> y, double rms) { wrap(y, kOverflow * rms); }
// Few jumps: with more of them, a fit that includes springs does not converge.
void seldom_overflown(Eigen::Ref<VectorXd> y, double rms) { wrap(y, 3 * rms); }
void without_sign(Eigen::Ref<VectorXd> y, double) { y = y.cwiseAbs(); }
void late(Eigen::Ref<VectorXd> y, double) {
  const VectorXd before = y.head(y.size() - 3);
  y.tail(before.size()) = before;
}
void loose(Eigen::Ref<VectorXd> y, double rms) {
  double held = 0;
  for (double& value : y) value = held = std::clamp(held, value - 0.3 * rms, value + 0.3 * rms);
}

class UserSystem : public ::testing::TestWithParam<LeftOut> {
 protected:
  static std::size_t samples() { return test::is_long() ? 2400 : 1600; }
  // Recordings of a chain of masses: input u, displacements y1 …, and the simulated first
  // displacement without the effect.
  void record(const Truth& chain) {
    const std::size_t count = samples();
    const auto rows = static_cast<double>(count);
    std::vector<double> deviations;
    double rms =
        0;  // of the first output in the first record: sets the effect's size in all records
    for (unsigned k = 0; k < std::size(kFiles); ++k) {
      auto u = test_support::random_signal(10 + k, count, kStep, 0.5, 12, kPush);
      std::fill_n(u.begin(), kRest, 0.0);
      Truth truth = chain;
      if (GetParam().in_system) GetParam().in_system(truth);
      MatrixXd y = test_support::motion_of(truth, u, kStep);
      const MatrixXd simulated = test_support::motion_of(chain, u, kStep);
      if (k == 0) rms = std::sqrt(y.col(0).squaredNorm() / rows);
      if (GetParam().in_first_output) GetParam().in_first_output(y.col(0), rms);
      test_support::Columns columns{
          {"u", u}, {"simulated", {simulated.col(0).begin(), simulated.col(0).end()}}};
      for (Index i = 0; i < y.cols(); ++i) {
        if (k == 0) deviations.push_back(kNoise * std::sqrt(y.col(i).squaredNorm() / rows));
        auto values = test_support::noise(100 * k + static_cast<unsigned>(i), count,
                                          deviations[static_cast<std::size_t>(i)]);
        for (std::size_t j = 0; j < count; ++j) values[j] += y(static_cast<Index>(j), i);
        columns[fmt::format("y{}", i + 1)] = values;
      }
      folder_.write(kFiles[k], columns);
    }
  }
  Verdict diagnosed(const std::string& channels_and_model) const {
    std::string toml = "format = 1\n";
    for (const char* file : kFiles)
      toml += fmt::format("[[record]]\nfile = \"{}\"\nuse = \"{}\"\nquiet_s = [0, {}]\n", file,
                          file == kFiles[0] ? "fit" : "held_out", (kRest - 5) * kStep);
    return diagnose(folder_.load(toml + "[channels]\nrate_Hz = 200\n" + channels_and_model));
  }
  static void check(const Verdict& verdict) {
    const auto& names = GetParam().names;
    RecordProperty("sentence", verdict.sentence);
    if (names.empty()) {
      EXPECT_EQ(verdict.conclusion.outcome, Outcome::None) << verdict.sentence;
      return;
    }
    ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
    ASSERT_EQ(verdict.conclusion.causes.size(), 1U) << verdict.sentence;
    const Cause& cause = verdict.conclusion.causes[0];
    EXPECT_NE(std::find(names.begin(), names.end(), cause.name + " at " + cause.channel),
              names.end())
        << cause.name << " at " << cause.channel << ": " << verdict.sentence;
    EXPECT_GT(cause.explained, 0.95) << verdict.sentence;
    const RecordScore& proof = verdict.evaluation.fit.back();
    EXPECT_LT(proof.nrmse_after, 1.2 * proof.noise_floor + by_jumps()) << verdict.sentence;
    EXPECT_GT(proof.nrmse_before, 2 * proof.nrmse_after) << verdict.sentence;
  }

  // A sample between the limit of an overflow and its estimate jumps to the other end of the range.
  // Three samples of a record may.
  static double by_jumps() {
    constexpr double kJump = 2 * kOverflow;  // of the rms
    return GetParam().effect == "overflow"
               ? std::sqrt(3 * kJump * kJump / static_cast<double>(samples()))
               : 0;
  }

  test_support::CaseFolder folder_;
};

using MassesOnSprings = UserSystem;
TEST_P(MassesOnSprings, NameTheLeftOutEffect) {
  Truth chain;
  chain.masses = VectorXd{{2, 1.5, 1}};
  chain.stiffness = VectorXd{{4000, 3000, 2500}};
  chain.damping = VectorXd{{6, 4, 3}};
  record(chain);

  check(diagnosed(R"(input.u = "u [N]"
output.a = "y1 [m]"
output.c = "y3 [m]"
[model]
kind = "mass_spring_damper"
masses_kg = [2.0, 1.5, 1.0]
fitted = ["spring.1.stiffness", "spring.2.stiffness", "spring.3.stiffness",
          "spring.1.damping", "spring.2.damping", "spring.3.damping"]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 4100
damping_N_s_per_m = 5
[[model.spring]]
between = [1, 2]
stiffness_N_per_m = 2900
damping_N_s_per_m = 5
[[model.spring]]
between = [2, 3]
stiffness_N_per_m = 2600
damping_N_s_per_m = 4
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.a" = "displacement.1"
"output.c" = "displacement.3"
)"));
}

INSTANTIATE_TEST_SUITE_P(
    Of, MassesOnSprings,
    ::testing::Values(
        LeftOut{"nothing", {}, {}}, LeftOut{"saturation", {"saturation at input.u"}, saturate},
        LeftOut{"delay", {"actuator_delay at input.u"}, delay},
        LeftOut{"softening", {"cubic_stiffness at spring.1"}, soften},
        LeftOut{"friction", {"coulomb_friction at spring.1"}, rub},
        LeftOut{"local_friction", {"position_dependent_friction at spring.1"}, rub_locally},
        LeftOut{"play",
                {"transducer_backlash at spring.3"},
                [](Truth& truth) { truth.hysteretic = 2, truth.gap = 1e-3; }},
        LeftOut{"overflow", {"overflow at output.a"}, {}, seldom_overflown}),
    name_of);

using LinearSystems = UserSystem;
TEST_P(LinearSystems, NameTheLeftOutEffect) {
  Truth chain;
  chain.masses = VectorXd{{2}};
  chain.stiffness = VectorXd{{4000}};
  chain.damping = VectorXd{{16}};
  record(chain);

  check(diagnosed(R"(input.u = "u [V]"
output.y = "y1 [V]"
[model]
kind = "linear"
input = "input.u"
output = "output.y"
numerator = [1]
denominator = [2.1, 15, 4100]
fitted = ["denominator.1", "denominator.2", "denominator.3"]
)"));
}

// A lag or a delay before a linear system is equivalent to one after it.
INSTANTIATE_TEST_SUITE_P(
    Of, LinearSystems,
    ::testing::Values(LeftOut{"nothing", {}, {}},
                      LeftOut{"dead_zone", {"input_dead_zone at input.u"}, leave_dead_zone},
                      LeftOut{"lost_signs", {"absolute_value_sensor at input.u"}, lose_signs},
                      LeftOut{"lag",
                              {"first_order_lag at input.u", "filter_lag at output.y"},
                              [](Truth& truth) { truth.input_lag = 0.015; }},
                      LeftOut{"softening", {"cubic_stiffness at output.y"}, soften},
                      LeftOut{"play", {"transducer_backlash at output.y"}, loosen},
                      LeftOut{"friction", {"coulomb_friction at output.y"}, rub},
                      LeftOut{"saturation", {"saturation at output.y"}, {}, saturated}),
    name_of);

using Predictions = UserSystem;
TEST_P(Predictions, NameTheLeftOutEffect) {
  Truth chain;
  chain.masses = VectorXd{{2}};
  chain.stiffness = VectorXd{{4000}};
  chain.damping = VectorXd{{16}};
  record(chain);

  check(diagnosed(R"(input.u = "u [V]"
output.y = "y1 [V]"
predicted.output.y = "simulated [V]"
[model]
kind = "data"
)"));
}

INSTANTIATE_TEST_SUITE_P(
    Of, Predictions,
    ::testing::Values(LeftOut{"nothing", {}, {}},
                      LeftOut{
                          "lost_signs", {"absolute_value_sensor at output.y"}, {}, without_sign},
                      LeftOut{"lag", {"filter_lag at output.y"}, {}, lagging},
                      LeftOut{"delay", {"time_skew at output.y"}, {}, late},
                      LeftOut{"play", {"transducer_backlash at output.y"}, {}, loose},
                      LeftOut{"overflow", {"overflow at output.y"}, {}, overflown}),
    name_of);

// A gain error of a motion between 55 and 75 Hz: two third octaves hold it, [45.3, 57.0] to
// [57.0, 71.8] and [71.8, 90.5] Hz.
TEST(Place, CoversAllFrequenciesOfARecord) {
  constexpr double kFastStep = 0.002;
  constexpr std::size_t kSamples = 2500, kStill = 500;
  test_support::CaseFolder folder;
  for (const unsigned seed : {1U, 2U}) {
    auto simulated = test_support::random_signal(seed, kSamples, kFastStep, 55, 75, 1);
    std::fill_n(simulated.begin(), kStill, 0.0);
    auto measured = test_support::noise(seed + 10, kSamples, 0.01);
    for (std::size_t i = 0; i < kSamples; ++i) measured[i] += 1.1 * simulated[i];
    folder.write(seed == 1 ? "fit.csv" : "held.csv", {{"y", measured}, {"simulated", simulated}});
  }

  const Verdict verdict = diagnose(folder.load(R"(format = 1
[[record]]
file = "fit.csv"
use = "fit"
quiet_s = [0, 1]
[[record]]
file = "held.csv"
use = "held_out"
[channels]
rate_Hz = 500
output.y = "y [V]"
predicted.output.y = "simulated [V]"
[model]
kind = "data"
)"));

  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  EXPECT_EQ(verdict.conclusion.causes[0].name, "gain");
  ASSERT_FALSE(verdict.conclusion.where.bands.empty());
  EXPECT_GT(verdict.conclusion.where.bands.front().first, 45);
  EXPECT_LT(verdict.conclusion.where.bands.back().second, 91);
}

}  // namespace
}  // namespace rths::diagnosis
