// SPDX-License-Identifier: Apache-2.0
// Equivalent descriptions of a system have the same response, which agrees with closed forms.
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/models/dynamic_relation.hpp>
#include "diagnosis/models/src/dynamic_reading.hpp"
#include "dynamic_case.hpp"
#include "support/files.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test_support::Columns;

constexpr double kKindsStep = 0.01;

// MAT version 4: a header of five words, the name, the values column by column.
TEST(MatrixFile, OfMatlabKeepsItsRowsAndColumns) {
  const test::TemporaryFolder folder;
  for (const auto& [rows, columns] : {std::pair{2, 3}, std::pair{3, 2}}) {
    const std::int32_t head[] = {0, rows, columns, 0, 2};
    const double values[] = {1, 2, 3, 4, 5, 6};
    std::string bytes{reinterpret_cast<const char*>(head), sizeof head};
    bytes += std::string{"C\0", 2};
    bytes.append(reinterpret_cast<const char*>(values), sizeof values);
    Config table;
    table.put("C", folder.write("c.mat", bytes).string());

    const MatrixXd expected = Eigen::Map<const MatrixXd>(values, rows, columns);
    EXPECT_EQ(read_matrix(table, "C"), expected);
  }
}

std::string records(const std::string& channels) {
  return R"(format = 1
[[record]]
file = "fit.csv"
use = "fit"
[channels]
rate_Hz = 100
)" + channels;
}

const std::string kForced = records("input.u = \"u [N]\"\noutput.y = \"y [m]\"\n");

const std::string kMassOnSpring = R"(
[model]
kind = "mass_spring_damper"
masses_kg = [2.0]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 800
damping_N_s_per_m = 8
)";

const std::string kOscillator = kMassOnSpring + R"([model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.y" = "displacement.1"
)";

class Kinds : public ::testing::Test {
 protected:
  Kinds() : u_(test_support::random_signal(4, 1500, kKindsStep, 0.3, 8, 30)) {
    folder_.write("fit.csv", {{"u", u_}, {"y", u_}});
  }
  MatrixXd answer(const std::string& toml) {
    case_ = folder_.load(toml);
    relation_ = dynamic_relation(case_);
    return test_support::prediction(*relation_, relation_->base(), case_.records[0]);
  }
  std::string error(const std::string& toml) {
    const auto message = test::error_of([&] { static_cast<void>(answer(toml)); });
    const auto at = message.find("case.toml");
    return at == std::string::npos ? message : message.substr(at);
  }

  test_support::CaseFolder folder_;
  std::vector<double> u_;
  Case case_;
  std::unique_ptr<Relation> relation_;
};

TEST_F(Kinds, ATransferFunctionHasTheResponseOfItsOscillator) {
  const MatrixXd oscillator = answer(kForced + kOscillator);

  const MatrixXd transfer = answer(kForced + R"(
[model]
kind = "linear"
input = "input.u"
output = "output.y"
numerator = [1.0]
denominator = [2.0, 8.0, 800.0]
)");

  EXPECT_LT(test_support::relative_error(transfer, oscillator), 1e-9);
}

TEST_F(Kinds, AStateSpaceHasTheResponseOfItsOscillator) {
  const MatrixXd oscillator = answer(kForced + kOscillator);

  const MatrixXd space = answer(kForced + R"(
[model]
kind = "linear"
inputs = ["input.u"]
outputs = ["output.y"]
A = [[0, 1], [-400, -4]]
B = [[0], [0.5]]
C = [[1, 0]]
)");

  EXPECT_LT(test_support::relative_error(space, oscillator), 1e-9);
}

TEST_F(Kinds, AStructureHasTheResponseOfItsMassesAndSprings) {
  const std::string channels = records(
      "acceleration.long = \"u [m/s2]\"\noutput.floor = \"y [m]\"\noutput.roof = \"y [m/s2]\"\n");
  const std::string ends = R"(
[model.inputs]
"acceleration.long" = "base_acceleration"
[model.outputs]
"output.floor" = "displacement.1"
"output.roof" = "acceleration.2"
)";
  const MatrixXd masses = answer(channels + R"(
[model]
kind = "mass_spring_damper"
masses_kg = [2.0, 1.0]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 900
damping_N_s_per_m = 8
[[model.spring]]
between = [1, 2]
stiffness_N_per_m = 500
damping_N_s_per_m = 2
)" + ends);
  const MatrixXd structure = answer(channels + R"(
[model]
kind = "structure"
mass = [[2.0, 0], [0, 1.0]]
stiffness = [[1400, -500], [-500, 500]]
damping = [[10, -2], [-2, 2]]
)" + ends);

  EXPECT_LT(test_support::relative_error(structure, masses), 1e-9);
  // The springs are derived from the stiffness matrix.
  EXPECT_EQ(relation_->candidates(relation_->base()).front().adds[0].component, "spring.1");
}

// A motion of the ground that begins at rest, and its acceleration: closed forms.
Columns ground_motion() {
  std::vector<double> ground, acceleration;
  for (std::size_t i = 0; i < 1500; ++i) {
    const double t = static_cast<double>(i) * kKindsStep, w = 2 * std::numbers::pi * 1.3;
    const double swell = 1 - std::exp(-t * t), rate = 2 * t * std::exp(-t * t);
    const double bend = (2 - 4 * t * t) * std::exp(-t * t);
    ground.push_back(swell * std::sin(w * t));
    acceleration.push_back(bend * std::sin(w * t) + 2 * rate * w * std::cos(w * t) -
                           swell * w * w * std::sin(w * t));
  }
  return {{"g", ground}, {"a", acceleration}, {"y", ground}};
}

// A displaced base is equivalent to an accelerated one, in absolute and in relative motion.
TEST_F(Kinds, ADisplacedBaseHasTheResponseOfAnAcceleratedBase) {
  folder_.write("fit.csv", ground_motion());
  const std::string model = kMassOnSpring + R"([model.outputs]
"output.y" = "deformation.1"
[model.inputs]
)";

  const MatrixXd displaced =
      answer(records("displacement.long = \"g [m]\"\noutput.y = \"y [m]\"\n") + model +
             "\"displacement.long\" = \"base_displacement\"\n");
  const MatrixXd accelerated =
      answer(records("acceleration.long = \"a [m/s2]\"\noutput.y = \"y [m]\"\n") + model +
             "\"acceleration.long\" = \"base_acceleration\"\n");

  // Linear interpolation between samples: (ω Δt)²/12 = 6e-4 of the force.
  EXPECT_LT(test_support::relative_error(displaced, accelerated), 3e-3);
}

// The absolute motion is the relative one and the ground's, whatever springs are listed. Half of
// the stiffness to the ground belongs to no connection, and the mass damps motion relative to it.
TEST_F(Kinds, ADisplacedBaseDrivesAStructureByAllOfItsMatrices) {
  Columns columns = ground_motion();
  folder_.write("fit.csv", columns);
  const std::string channels = "output.floor = \"y [m]\"\noutput.roof = \"y [m]\"\n";
  const std::string model = R"(
[model]
kind = "structure"
mass = [[2.0, 0], [0, 1.0]]
stiffness = [[1400, -500], [-500, 700]]
rayleigh = [1.5, 0.002]
[[model.spring]]
between = [1, 2]
[model.outputs]
"output.floor" = "displacement.1"
"output.roof" = "displacement.2"
[model.inputs]
)";

  const MatrixXd absolute = answer(records("displacement.long = \"g [m]\"\n" + channels) + model +
                                   "\"displacement.long\" = \"base_displacement\"\n");
  MatrixXd relative = answer(records("acceleration.long = \"a [m/s2]\"\n" + channels) + model +
                             "\"acceleration.long\" = \"base_acceleration\"\n");
  relative.colwise() += VectorXd::Map(columns["g"].data(), relative.rows());

  // Linear interpolation between samples: (ω Δt)²/12 = 6e-4 of the force.
  EXPECT_LT(test_support::relative_error(absolute, relative), 3e-3);
}

TEST_F(Kinds, ASystemInDiscreteTimeIsItsRecursion) {
  const MatrixXd predicted = answer(kForced + R"(
[model]
kind = "linear"
input = "input.u"
output = "output.y"
time_step_s = 0.01
numerator = [0.2, 0.1]
denominator = [1.0, -1.6, 0.8]
)");

  VectorXd expected = VectorXd::Zero(predicted.rows());
  for (Index i = 1; i < expected.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    expected[i] = 1.6 * expected[i - 1] + 0.2 * u_[at - 1];
    if (i > 1) expected[i] += -0.8 * expected[i - 2] + 0.1 * u_[at - 2];
  }
  EXPECT_LT(test_support::relative_error(predicted, expected), 1e-9);
}

// The steady-state response to a sine has the gain and phase of the transfer function.
TEST_F(Kinds, ATransferFunctionHasItsFrequencyResponse) {
  constexpr double kFrequency = 2.5;
  const double w = 2 * std::numbers::pi * kFrequency;
  std::vector<double> u;
  for (std::size_t i = 0; i < 4000; ++i)
    u.push_back(std::sin(w * kKindsStep * static_cast<double>(i)));
  folder_.write("fit.csv", {{"u", u}, {"y", u}});

  const MatrixXd predicted = answer(kForced + R"(
[model]
kind = "linear"
input = "input.u"
output = "output.y"
hold = "smooth"
numerator = [0.3, 7.0]
denominator = [2.0, 8.0, 800.0]
)");

  const std::complex<double> s{0, w};
  const auto gain = (0.3 * s + 7.0) / (2.0 * s * s + 8.0 * s + 800.0);
  VectorXd expected(1000);
  for (Index i = 0; i < expected.size(); ++i)
    expected[i] = std::imag(gain * std::exp(s * kKindsStep * static_cast<double>(i + 2500)));
  // Linear interpolation in substeps: (ω Δt/4)²/12 = 1.3e-4.
  EXPECT_LT(test_support::relative_error(predicted.middleRows(2500, 1000), expected), 3e-4);
}

// ∫ min(u, limit) dt of a signal that is linear between two samples, 0 ≤ u.
double limited_area(double from, double to, double limit, double step) {
  const double low = std::min(from, to), high = std::max(from, to);
  const double beyond = high > limit ? (high - std::max(low, limit)) / (high - low) : 0;
  const double excess = 0.5 * beyond * (high - limit + std::max(low - limit, 0.0));
  return step * (0.5 * (from + to) - excess);
}

// A signal that is limited at its samples alone loses Δu Δt/12 on average where it meets the limit,
// at most Δu Δt/8. With a sixteenth of that, all losses have the same sign here.
TEST_F(Kinds, ASaturationLimitsItsSignalBetweenSamplesToo) {
  constexpr double kLimit = 1.3;
  std::vector<double> u;
  for (int i = 0; i < 400; ++i) u.push_back(1 - std::cos(0.4 * i));
  folder_.write("fit.csv", {{"u", u}, {"y", u}});

  const MatrixXd integral = answer(kForced + R"(
[model]
kind = "linear"
input = "input.u"
output = "output.y"
numerator = [1.0]
denominator = [1.0, 0.0]
[model.terms."input.u".saturation]
limit_N = 1.3
)");

  double expected = 0, allowed = 0;
  for (Index i = 1; i < integral.rows(); ++i) {
    const double from = u[static_cast<std::size_t>(i) - 1], to = u[static_cast<std::size_t>(i)];
    expected += limited_area(from, to, kLimit, kKindsStep);
    if ((from - kLimit) * (to - kLimit) < 0) allowed += std::abs(to - from) * kKindsStep / 8 / 16;
    ASSERT_NEAR(integral(i, 0), expected, allowed + 1e-12) << i;
  }
}

TEST_F(Kinds, AnUnknownStartStateIsFound) {
  const MatrixXd whole = answer(kForced + kOscillator);
  const std::vector<double> late(u_.begin() + 700, u_.end());
  const std::vector<double> measured(whole.data() + 700, whole.data() + whole.rows());
  folder_.write("fit.csv", {{"u", late}, {"y", measured}});

  const MatrixXd at_rest = answer(kForced + kOscillator);
  std::string free = kOscillator;
  free.insert(free.find("masses_kg"), "initial = \"free\"\n");
  const MatrixXd found = answer(kForced + free);

  const MatrixXd expected = whole.bottomRows(whole.rows() - 700);
  EXPECT_GT(test_support::relative_error(at_rest, expected), 0.01);
  EXPECT_LT(test_support::relative_error(found, expected), 1e-6);
}

// A free decay. The stated spring is 3 % too stiff: a state that fits the beginning with it is none
// of the right spring.
TEST_F(Kinds, AnUnknownStartStateFollowsTheParameters) {
  constexpr double kDecay = 2, kFrequency = 20;  // c/(2 m), √(k/m) [rad/s]
  const double damped = std::sqrt(kFrequency * kFrequency - kDecay * kDecay);
  VectorXd decay(300);
  for (Index i = 0; i < decay.size(); ++i) {
    const double t = kKindsStep * static_cast<double>(i);
    decay[i] = 0.01 * std::exp(-kDecay * t) * std::cos(damped * t - 0.4);
  }
  folder_.write("fit.csv", {{"u", std::vector<double>(300)}, {"y", {decay.begin(), decay.end()}}});
  std::string free = kOscillator;
  free.replace(free.find("= 800"), 5, "= 824");
  free.insert(free.find("masses_kg"), "initial = \"free\"\nfitted = [\"spring.1.stiffness\"]\n");
  case_ = folder_.load(kForced + free);
  relation_ = dynamic_relation(case_);
  const auto drive = relation_->prepare(case_.records[0]);
  const auto simulator = relation_->simulator(relation_->base(), *drive);
  MatrixXd prediction, stiffer;
  std::vector<MatrixXd> derivatives, none;

  ASSERT_TRUE(simulator->run(VectorXd::Constant(1, 800), {0}, prediction, derivatives));
  ASSERT_TRUE(simulator->run(VectorXd::Constant(1, 800.1), {}, stiffer, none));

  EXPECT_LT(test_support::relative_error(prediction, decay), 1e-6);
  EXPECT_LT(test_support::relative_error((stiffer - prediction) / 0.1, derivatives[0]), 1e-3);
}

TEST_F(Kinds, DataWithAnAddedTermIsTheirSum) {
  std::vector<double> predicted, displacement;
  for (std::size_t i = 0; i < 400; ++i) {
    displacement.push_back(0.05 * std::sin(0.07 * static_cast<double>(i)));
    predicted.push_back(3000 * displacement.back());
  }
  folder_.write("fit.csv", {{"u", displacement}, {"p", predicted}, {"y", predicted}});
  const std::string data = records(
                               "displacement.long = \"u [m]\"\nforce.long = \"y [N]\"\n"
                               "predicted.force.long = \"p [N]\"\n") +
                           "[model]\nkind = \"data\"\n";
  EXPECT_LT(test_support::relative_error(answer(data), VectorXd::Map(predicted.data(), 400)),
            1e-12);

  const MatrixXd with_term =
      answer(data + "[model.terms.\"added.1\".cubic_stiffness]\nstiffness_N_per_m3 = 1e6\n");

  VectorXd expected(400);
  for (Index i = 0; i < 400; ++i) {
    const auto at = static_cast<std::size_t>(i);
    expected[i] = predicted[at] + 1e6 * std::pow(displacement[at], 3);
  }
  EXPECT_LT(test_support::relative_error(with_term, expected), 1e-12);
}

// At an angle of w h per sample, five-point differences lack (w h)^4/30 of the first and (w h)^4/90
// of the second rate.
TEST_F(Kinds, DataWithADamperAndAMassHaveTheRatesOfASine) {
  constexpr double kAngle = 0.4, kRate = kAngle / kKindsStep;
  std::vector<double> nothing(400, 0.0), displacement;
  for (std::size_t i = 0; i < 400; ++i)
    displacement.push_back(std::sin(kAngle * static_cast<double>(i)));
  folder_.write("fit.csv", {{"u", displacement}, {"p", nothing}, {"y", nothing}});
  const std::string data = records(
                               "displacement.long = \"u [m]\"\nforce.long = \"y [N]\"\n"
                               "predicted.force.long = \"p [N]\"\n") +
                           "[model]\nkind = \"data\"\n[model.terms.\"added.1\"]\n";

  const MatrixXd damped = answer(data + "viscous_friction = {coefficient_N_s_per_m = 1}\n");
  const MatrixXd heavy = answer(data + "platen_inertia = {mass_kg = 1}\n");

  constexpr double kMissing = kAngle * kAngle * kAngle * kAngle;
  for (Index i = 2; i < 398; ++i) {
    const double angle = kAngle * static_cast<double>(i);
    ASSERT_NEAR(damped(i, 0), kRate * std::cos(angle), kRate * kMissing / 30);
    ASSERT_NEAR(heavy(i, 0), -kRate * kRate * std::sin(angle), kRate * kRate * kMissing / 90);
  }
}

TEST_F(Kinds, ReportErrorsInTheirTables) {
  const std::string linear = kForced + R"([model]
kind = "linear"
input = "input.u"
output = "output.y"
)";
  EXPECT_EQ(error(linear + "numerator = [1, 2, 3]\ndenominator = [1, 2]\n"),
            "case.toml:13:13: numerator is of order 2, denominator of order 1: expected at most "
            "the denominator's order");
  std::string long_polynomial = "1";
  for (int i = 0; i < 21; ++i) long_polynomial += ", 1";
  EXPECT_EQ(error(linear + "numerator = [1]\ndenominator = [" + long_polynomial + "]\n"),
            "case.toml:14:15: denominator is of order 21, expected at most 20: give a larger "
            "system as matrices A, B, C");
  EXPECT_EQ(error(linear + "numerator = [1]\ndenominator = [0, 2]\n"),
            "case.toml:14:15: denominator must begin with a number that is not 0: that of the "
            "highest power");
  EXPECT_EQ(error(linear + "numerator = [1]\ndenominator = [1, 2]\ntime_step_s = 0.02\n"),
            "fit.csv: sampled every 0.01 s, but the model has a time step of 0.02 s");
  EXPECT_EQ(error(linear + "numerator = [1]\ndenominator = [1, 2]\nhold = \"long\"\n"),
            "case.toml:15:8: hold is 'long', expected linear, zero or smooth");
  EXPECT_EQ(
      error(linear + "numerator = [1]\ndenominator = [1, 2]\n"
                     "[model.terms.\"input.w\".saturation]\nlimit_N = 2\n"),
      "case.toml:15:1: there is no component 'input.w' for terms, expected one of \"input.u\", "
      "\"output.y\", \"feedback.1\"");
  const std::string structure = kForced + "[model]\nkind = \"structure\"\n";
  EXPECT_EQ(error(structure + "mass = [[1, 2], [0, 1]]\nstiffness = [[1, 0], [0, 1]]\n"),
            "case.toml:11:8: mass is not symmetric");
  EXPECT_EQ(error(structure + "mass = [[1, 0], [0]]\nstiffness = [[1, 0], [0, 1]]\n"),
            "case.toml:11:17: mass has a row of 1 numbers, the first has 2");
  EXPECT_EQ(error(kForced + "[model]\nkind = \"data\"\n"),
            "fit.csv: a model of kind 'data' needs its prediction as a channel, as in "
            "predicted.force.long");
}

}  // namespace
}  // namespace rths::diagnosis
