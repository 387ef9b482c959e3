// SPDX-License-Identifier: Apache-2.0
// The improved case that a diagnosis writes runs as it is: its diagnosis names no further term, and
// its model predicts as stated what the first diagnosis had fitted.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/cases/against.hpp>
#include <rths/report/diagnosis.hpp>

#include "dynamic_truth.hpp"
#include "one_axis.hpp"
#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test_support::Columns;
using test_support::Truth;

constexpr const char* kFiles[] = {"fit.csv", "second.csv", "third.csv"};

std::string records(double rest) {
  std::string toml = "format = 1\nname = \"first\"\n";
  for (const char* file : kFiles)
    toml += fmt::format("[[record]]\nfile = \"{}\"\nuse = \"{}\"\nquiet_s = [0, {}]\n", file,
                        file == kFiles[0] ? "fit" : "held_out", rest);
  return toml;
}

/// The verdicts on a case and on the improved case that it led to.
struct RoundTrip {
  Verdict first, second;
};

class ImprovedCase : public ::testing::Test {
 protected:
  RoundTrip round_trip(const std::string& toml) const {
    RoundTrip result;
    result.first = diagnose(folder_.load(toml));
    const auto files = report::write_diagnosis(result.first, folder_.path() / "out");
    if (files.improved) result.second = diagnose(load_case(folder_.path() / "out/improved"));
    return result;
  }
  static void check(const RoundTrip& trip, const std::string& name) {
    ASSERT_EQ(trip.first.conclusion.outcome, Outcome::Missing) << trip.first.sentence;
    EXPECT_EQ(trip.first.conclusion.causes[0].name, name) << trip.first.sentence;
    ASSERT_FALSE(trip.second.sentence.empty()) << "there is no improved case";
    // A residual may remain, but no further term.
    EXPECT_TRUE(trip.second.conclusion.causes.empty()) << trip.second.sentence;
    EXPECT_EQ(trip.second.case_name, "first, improved");
    const RecordScore &before = trip.first.evaluation.fit.back(),
                      &after = trip.second.evaluation.fit.back();
    EXPECT_EQ(after.record, before.record);
    // The file has nine digits of each parameter.
    EXPECT_NEAR(after.nrmse_stated, before.nrmse_after, 1e-3 * before.nrmse_after);
    for (const auto& stated : trip.second.evaluation.refitted)
      for (const auto& fitted : trip.first.evaluation.refitted)
        if (stated.name == fitted.name) {
          EXPECT_NEAR(stated.stated, fitted.after, 1e-7 * std::abs(fitted.after)) << stated.name;
        }
  }
  // Motion of a platen or bearing, and the force of a specimen that is new in each record.
  template <class Make>
  void record_force(const Make& specimen) const {
    for (unsigned k = 0; k < std::size(kFiles); ++k)
      write(kFiles[k], test_support::record_of(kFiles[k], Use::Fit, k + 1, specimen(),
                                               {.length = test_support::kShortLength}));
  }
  void write(const char* file, const Record& record) const {
    Columns columns;
    for (const auto& channel : record.channels) columns[channel.role] = channel.values;
    for (std::size_t i = 0; i < record.samples(); ++i)
      columns["t"].push_back(static_cast<double>(i) * record.time_step);
    folder_.write(file, columns);
  }
  // Input and displacements of a chain of masses, and those without the effect.
  void record_chain(const Truth& truth, const Truth& simulated, std::size_t samples = 1600) const {
    constexpr std::size_t kStill = 400;
    constexpr double kStep = 0.005, kNoise = 0.003;
    for (unsigned k = 0; k < std::size(kFiles); ++k) {
      auto u = test_support::random_signal(10 + k, samples, kStep, 0.5, 12, 20);
      std::fill_n(u.begin(), kStill, 0.0);
      const MatrixXd y = test_support::motion_of(truth, u, kStep);
      const MatrixXd without = test_support::motion_of(simulated, u, kStep);
      Columns columns{{"u", u}};
      for (Index i = 0; i < y.cols(); ++i) {
        const double deviation =
            kNoise * std::sqrt(y.col(i).squaredNorm() / static_cast<double>(samples));
        auto values = test_support::noise(100 * k + static_cast<unsigned>(i), samples, deviation);
        for (std::size_t j = 0; j < samples; ++j) values[j] += y(static_cast<Index>(j), i);
        columns[fmt::format("y{}", i + 1)] = values;
        columns[fmt::format("s{}", i + 1)] = {without.col(i).begin(), without.col(i).end()};
      }
      folder_.write(kFiles[k], columns);
    }
  }

  static constexpr const char* kGuide =
      "[channels]\ntime = \"t [s]\"\ndisplacement.long = \"displacement.long [m]\"\n"
      "force.long = \"force.long [N]\"\n";
  static constexpr const char* kChain = "[channels]\nrate_Hz = 200\n";
  static constexpr double kRest = 1.975;  // of a chain [s]
  test_support::CaseFolder folder_;
};

// Coulomb friction with 0.1 mm of presliding: Dahl's law, solved exactly for each step.
class Rub {
 public:
  double operator()(double x) {
    const double way = x - before_, direction = way > 0 ? 1 : -1;
    side_ = direction + (side_ - direction) * std::exp(-std::abs(way) / 1e-4);
    before_ = x;
    return side_;
  }

 private:
  double side_ = 0, before_ = 0;
};

// A spring and a loop: Bouc and Wen's law with β = 0.2, by Heun's method.
class Loop {
 public:
  double operator()(double, double x, double) {
    constexpr int kParts = 10;
    const double du = (x - before_) / kParts;
    before_ = x;
    const auto rate = [&](double z) {
      return (1 - z * z * (0.8 + (z * du > 0 ? 0.2 : -0.2))) / 0.008 * du;
    };
    for (int i = 0; i < kParts; ++i) {
      const double first = rate(z_);
      z_ += 0.5 * (first + rate(z_ + first));
    }
    return 2e5 * x + 4e4 * z_;
  }

 private:
  double z_ = 0, before_ = 0;
};

TEST_F(ImprovedCase, OfAPlatenHasItsFriction) {
  record_force([] {
    return [rub = Rub{}](double, double x, double v) mutable {
      return 2e5 * x + 3e3 * v + 300 * rub(x);
    };
  });

  check(round_trip(records(1.9) + kGuide + R"([model]
kind = "platen"
fitted = ["polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"]
[model.polynomial_stiffness]
axes = ["long"]
linear_N_per_m = 210_000
[model.viscous_friction]
axes = ["long"]
coefficient_N_s_per_m = 2_500
[model.force_offset]
kind = "offset"
channel = "force"
offset_N = 0
)"),
        "coulomb_friction");
}

TEST_F(ImprovedCase, OfABearingHasItsRuleOfHysteresis) {
  record_force([] { return Loop{}; });

  check(round_trip(records(1.9) + kGuide + R"([model]
kind = "bearing"
fitted = ["bouc_wen.characteristic_strength", "bouc_wen.post_yield_stiffness",
          "bouc_wen.yield_displacement", "bouc_wen.eta", "force_offset.offset"]
[model.bouc_wen]
characteristic_strength_N = 42_000
post_yield_stiffness_N_per_m = 210_000
yield_displacement_m = 0.009
[model.force_offset]
kind = "offset"
channel = "force"
offset_N = 0
)"),
        "unloading_rule");
}

TEST_F(ImprovedCase, OfAnAxisHasItsLag) {
  constexpr double kStep = 0.002, kTimeConstant = 0.02, kDamping = 0.7;
  constexpr std::size_t kSamples = 10000, kStill = 1000;
  for (unsigned k = 0; k < std::size(kFiles); ++k) {
    auto command = test_support::random_signal(20 + k, kSamples, kStep, 0.3, 8, 0.01);
    std::fill_n(command.begin(), kStill, 0.0);
    const auto at = test_support::interpolated(command, kStep);
    const auto motion = test_support::integrated(
        [&](double t, const VectorXd& x) {
          return VectorXd{{x[1], (at(t) - x[0] - 2 * kDamping * kTimeConstant * x[1]) /
                                     (kTimeConstant * kTimeConstant)}};
        },
        VectorXd::Zero(2), kSamples, kStep);
    auto measured = test_support::noise(k, kSamples, 1e-5);
    for (std::size_t i = 0; i < kSamples; ++i) measured[i] += motion[i][0];
    folder_.write(kFiles[k], {{"c", command}, {"x", measured}});
  }

  // An oil column with so much damping is the same law.
  check(
      round_trip(records(1.9) + "[channels]\nrate_Hz = 500\ncommand.long = \"c [m]\"\n"
                                "displacement.long = \"x [m]\"\n[model]\nkind = \"servo_axis\"\n"),
      "actuator_bandwidth");
}

TEST_F(ImprovedCase, OfMassesHasASpring) {
  Truth chain;
  chain.masses = VectorXd{{2, 1.5}};
  chain.stiffness = VectorXd{{4000, 3000}};
  chain.damping = VectorXd{{6, 4}};
  Truth truth = chain;
  truth.spring = [](Index i, double d, double) { return i == 0 ? -5e5 * d * d * d : 0; };
  record_chain(truth, chain, 2400);

  check(round_trip(records(kRest) + kChain + R"(input.u = "u [N]"
output.a = "y1 [m]"
output.b = "y2 [m]"
[model]
kind = "mass_spring_damper"
masses_kg = [2.0, 1.5]
fitted = ["spring.1.stiffness", "spring.2.stiffness", "spring.1.damping", "spring.2.damping"]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 4100
damping_N_s_per_m = 5
[[model.spring]]
between = [1, 2]
stiffness_N_per_m = 2900
damping_N_s_per_m = 5
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.a" = "displacement.1"
"output.b" = "displacement.2"
)"),
        "cubic_stiffness");
}

TEST_F(ImprovedCase, OfAStructureHasFrictionInASpring) {
  Truth chain;
  chain.masses = VectorXd{{2, 1.5}};
  chain.stiffness = VectorXd{{4000, 3000}};
  chain.damping = VectorXd{{6, 4}};
  Truth truth = chain;
  truth.gain = 3;
  truth.memory_rate = [](double s, double v) { return (v - s * std::abs(v)) / 2e-4; };
  record_chain(truth, chain);

  check(round_trip(records(kRest) + kChain + R"(input.u = "u [N]"
output.a = "y1 [m]"
output.b = "y2 [m]"
[model]
kind = "structure"
mass = [[2, 0], [0, 1.5]]
stiffness = [[7100, -3050], [-3050, 3050]]
damping = [[11, -4.4], [-4.4, 4.4]]
fitted = ["stiffness.1.1", "stiffness.1.2", "stiffness.2.2", "damping.factor"]
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.a" = "displacement.1"
"output.b" = "displacement.2"
)"),
        "coulomb_friction");
}

TEST_F(ImprovedCase, OfALinearSystemHasTheDeadZoneOfItsInput) {
  Truth chain;
  chain.masses = VectorXd{{2}};
  chain.stiffness = VectorXd{{4000}};
  chain.damping = VectorXd{{16}};
  Truth truth = chain;
  truth.input = [](const auto& u, double t) { return u(t) - std::clamp(u(t), -4.0, 4.0); };
  record_chain(truth, chain);

  check(round_trip(records(kRest) + kChain + R"(input.u = "u [V]"
output.y = "y1 [V]"
[model]
kind = "linear"
input = "input.u"
output = "output.y"
numerator = [1]
denominator = [2.1, 15, 4100]
fitted = ["denominator.1", "denominator.2", "denominator.3"]
)"),
        "input_dead_zone");
}

TEST_F(ImprovedCase, OfAPredictionHasTheGainOfItsSensor) {
  Truth chain;
  chain.masses = VectorXd{{2}};
  chain.stiffness = VectorXd{{4000}};
  chain.damping = VectorXd{{16}};
  Truth truth = chain;
  truth.pushed = 0;
  truth.input = [](const auto& u, double t) { return 1.05 * u(t); };
  record_chain(truth, chain);

  check(round_trip(records(kRest) + kChain + R"(output.y = "y1 [V]"
predicted.output.y = "s1 [V]"
[model]
kind = "data"
)"),
        "gain");
}

TEST_F(ImprovedCase, HasTheCoarseStepsOfASensor) {
  for (unsigned k = 0; k < std::size(kFiles); ++k)
    write(kFiles[k],
          test_support::record_of(kFiles[k], Use::Fit, k + 1,
                                  [](double, double x, double v) { return 2e5 * x + 3e3 * v; },
                                  {.force_step = 400}));

  const RoundTrip trip = round_trip(records(1.9) + kGuide + R"([model]
kind = "platen"
fitted = ["polynomial_stiffness.linear", "viscous_friction.coefficient", "force_offset.offset"]
[model.polynomial_stiffness]
axes = ["long"]
linear_N_per_m = 210_000
[model.viscous_friction]
axes = ["long"]
coefficient_N_s_per_m = 2_500
[model.force_offset]
kind = "offset"
channel = "force"
offset_N = 0
)");

  ASSERT_EQ(trip.first.conclusion.causes.size(), 1U) << trip.first.sentence;
  EXPECT_EQ(trip.first.conclusion.causes[0].name, "force_quantisation");
  EXPECT_EQ(trip.second.conclusion.outcome, Outcome::None) << trip.second.sentence;
}

// The prediction of another program belongs to the case from then on.
TEST_F(ImprovedCase, OfAnotherSimulationRefersToItsFile) {
  Truth chain;
  chain.masses = VectorXd{{2}};
  chain.stiffness = VectorXd{{4000}};
  chain.damping = VectorXd{{16}};
  Truth truth = chain;
  truth.input = [](const auto& u, double t) { return 1.05 * u(t); };
  record_chain(truth, chain);
  const auto u = test_support::random_signal(10, 1600, 0.005, 0.5, 12, 20);
  auto still = u;
  std::fill_n(still.begin(), 400, 0.0);
  const MatrixXd simulated = test_support::motion_of(chain, still, 0.005);
  Columns columns{{"output.y", {simulated.col(0).begin(), simulated.col(0).end()}}};
  for (int i = 0; i < 1600; ++i) columns["time"].push_back(0.005 * i);
  folder_.write("simulated.csv", columns);
  const Case given = folder_.load(records(kRest) + kChain + "output.y = \"y1 [V]\"\n");

  const Verdict first = diagnose(with_prediction(given, folder_.path() / "simulated.csv"));
  static_cast<void>(report::write_diagnosis(first, folder_.path() / "out"));
  const Verdict second = diagnose(load_case(folder_.path() / "out/improved"));

  ASSERT_EQ(first.conclusion.outcome, Outcome::Missing) << first.sentence;
  EXPECT_EQ(second.conclusion.outcome, Outcome::None) << second.sentence;
}

}  // namespace
}  // namespace rths::diagnosis
