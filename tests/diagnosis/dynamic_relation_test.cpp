// SPDX-License-Identifier: Apache-2.0
#include <rths/models/dynamic_relation.hpp>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "dynamic_case.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kOscillatorStep = 0.01;

constexpr const char* kOscillatorCase = R"(format = 1
[[record]]
file = "fit.csv"
use = "fit"
[channels]
rate_Hz = 100
input.u = "u [N]"
output.y = "y [m]"
[model]
kind = "mass_spring_damper"
masses_kg = [2.0]
fitted = ["mass.1", "spring.1.stiffness", "spring.1.damping"]
[[model.spring]]
between = [0, 1]
stiffness_N_per_m = 800
damping_N_s_per_m = 8
[model.inputs]
"input.u" = "force.1"
[model.outputs]
"output.y" = "displacement.1"
)";

class Oscillator : public ::testing::Test {
 protected:
  // Solves m x'' + c x' + k x + extra(x, x') = u.
  template <class Extra>
  std::vector<double> answer(const std::vector<double>& u, Extra extra) const {
    const auto force = test_support::interpolated(u, kOscillatorStep);
    const auto states = test_support::integrated(
        [&](double t, const VectorXd& x) {
          return VectorXd{{x[1], (force(t) - 8 * x[1] - 800 * x[0] - extra(x[0], x[1])) / 2.0}};
        },
        VectorXd::Zero(2), u.size(), kOscillatorStep);
    std::vector<double> y;
    for (const auto& x : states) y.push_back(x[0]);
    return y;
  }
  const Case& with(const std::vector<double>& u, const std::vector<double>& y,
                   const std::string& more = "") {
    folder_.write("fit.csv", {{"u", u}, {"y", y}});
    case_ = folder_.load(kOscillatorCase + more);
    relation_ = dynamic_relation(case_);
    return case_;
  }
  MatrixXd predicted(const Hypothesis& hypothesis) const {
    return test_support::prediction(*relation_, hypothesis, case_.records[0]);
  }
  MatrixXd measured() const { return relation_->prepare(case_.records[0])->measured; }
  Hypothesis base_with(const std::vector<ModelTerm>& terms) const {
    Hypothesis hypothesis = relation_->base();
    hypothesis.terms.insert(hypothesis.terms.end(), terms.begin(), terms.end());
    return hypothesis;
  }

  test_support::CaseFolder folder_;
  Case case_;
  std::unique_ptr<Relation> relation_;
};

// The recorded input lacks a pulse in a gap from 5 to 5.5 s. What it causes decays with exp(-2 t).
TEST_F(Oscillator, IsNotComparedUntilItHasForgottenTheInputsOfAGap) {
  std::vector<double> u(2000), recorded;
  for (std::size_t i = 0; i < u.size(); ++i) u[i] = 40 * std::sin(0.07 * static_cast<double>(i));
  recorded = u;
  for (std::size_t i = 501; i < 550; ++i) u[i] += 40;
  with(recorded, answer(u, [](double, double) { return 0.0; }));
  Record record = case_.records[0];
  record.gaps = {{500, 550}};

  const auto drive = relation_->prepare(record);

  const MatrixXd error =
      (drive->measured - test_support::prediction(*relation_, relation_->base(), record))
          .cwiseAbs();
  const double largest = drive->measured.cwiseAbs().maxCoeff();
  EXPECT_GT(error.maxCoeff(), 0.3 * largest);
  EXPECT_LT(drive->compared_rows(error).maxCoeff(), 1.1e-3 * largest);
  EXPECT_EQ(drive->present.head(500).minCoeff(), 1);
  // ln(1000)/2 = 3.5 s, and what the pulse exceeds the static displacement.
  EXPECT_EQ(drive->present.tail(2000 - 950).minCoeff(), 1);
  EXPECT_EQ(drive->present.segment(500, 300).maxCoeff(), 0);
}

TEST_F(Oscillator, HasTheStepResponseOfTheClosedForm) {
  const std::vector<double> u(500, 40.0);
  std::vector<double> y;
  const double decay = 8 / (2 * 2.0), damped = std::sqrt(800 / 2.0 - decay * decay);
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double t = static_cast<double>(i) * kOscillatorStep;
    y.push_back(40.0 / 800 *
                (1 - std::exp(-decay * t) *
                         (std::cos(damped * t) + decay / damped * std::sin(damped * t))));
  }

  with(u, y);

  EXPECT_LT(test_support::relative_error(predicted(relation_->base()), measured()), 1e-12);
}

TEST_F(Oscillator, FollowsAStiffeningSpring) {
  const auto u = test_support::random_signal(1, 3000, kOscillatorStep, 0.3, 6, 30);
  const double cubic = 4e4;
  with(u, answer(u, [&](double x, double) { return cubic * x * x * x; }));
  const double linear = test_support::relative_error(predicted(relation_->base()), measured());

  const auto error = test_support::relative_error(
      predicted(base_with({{{"cubic_stiffness", "", {{"stiffness", cubic}}}, "spring.1"}})),
      measured());

  EXPECT_GT(linear, 0.2);
  // The force is linear within a substep, an error of (ω Δt/4)²/12: 1e-3 at the third harmonic of
  // 15 Hz, where the spring is stiffest.
  EXPECT_LT(error, 2e-3);
}

TEST_F(Oscillator, FollowsFrictionWithPresliding) {
  const auto u = test_support::random_signal(2, 3000, kOscillatorStep, 0.3, 6, 30);
  // Dahl's ds = (dx − s |dx|)/z_s as a third state.
  const double friction = 6, presliding = 1e-3;
  const auto force = test_support::interpolated(u, kOscillatorStep);
  const auto states = test_support::integrated(
      [&](double t, const VectorXd& x) {
        const double slip = (x[1] - x[2] * std::abs(x[1])) / presliding;
        return VectorXd{{x[1], (force(t) - 8 * x[1] - 800 * x[0] - friction * x[2]) / 2.0, slip}};
      },
      VectorXd::Zero(3), u.size(), kOscillatorStep);
  std::vector<double> y;
  for (const auto& x : states) y.push_back(x[0]);
  with(u, y);

  const auto error = test_support::relative_error(
      predicted(base_with(
          {{{"coulomb_friction", "", {{"friction_force", friction}, {"presliding", presliding}}},
            "spring.1"}})),
      measured());

  EXPECT_GT(test_support::relative_error(predicted(relation_->base()), measured()), 0.1);
  EXPECT_LT(error, 5e-3);
}

// The reading of a sensor that overflows jumps by its span of 2 L. With a stiffness that is 3 %
// off, the prediction differs from it nowhere by more than the displacement does, though it jumps
// at other samples.
TEST_F(Oscillator, PredictsTheValueNextToAReadingThatOverflows) {
  const auto u = test_support::random_signal(3, 1200, kOscillatorStep, 0.3, 6, 30);
  const auto truth = answer(u, [](double, double) { return 0.0; });
  const double limit = 0.6 * *std::max_element(truth.begin(), truth.end());
  std::vector<double> read = truth;
  for (double& y : read) y -= 2 * limit * std::round(y / (2 * limit));
  with(u, read);
  Hypothesis base = relation_->base();
  base.values[1] *= 1.03;
  const MatrixXd unlimited = predicted(base);
  base.terms.push_back({{"overflow", "", {{"limit", limit}}}, "output.y"});

  const VectorXd error = predicted(base) - measured();

  const VectorXd displacement = VectorXd::Map(truth.data(), Index(truth.size()));
  EXPECT_LT((unlimited - displacement).cwiseAbs().maxCoeff(), limit);
  EXPECT_LT((error - (unlimited - displacement)).cwiseAbs().maxCoeff(), 1e-9 * limit);
}

// A late signal is not interpolated over the jumps of its reading.
TEST_F(Oscillator, OverflowsAfterAllOtherEffectsInAnyOrder) {
  const auto u = test_support::random_signal(3, 1200, kOscillatorStep, 0.3, 6, 30);
  const auto truth = answer(u, [](double, double) { return 0.0; });
  const double limit = 0.6 * *std::max_element(truth.begin(), truth.end());
  with(u, truth);
  const ModelTerm late{{"time_skew", "", {{"skew", 0.4 * kOscillatorStep}}}, "output.y"};
  const ModelTerm overflow{{"overflow", "", {{"limit", limit}}}, "output.y"};

  const MatrixXd right = predicted(base_with({late, overflow}));
  const MatrixXd found_first = predicted(base_with({overflow, late}));

  EXPECT_LT((right - found_first).cwiseAbs().maxCoeff(), 1e-12 * limit);
}

// Compares every candidate's derivatives with differences of the prediction.
TEST_F(Oscillator, HasTheDerivativesOfItsPrediction) {
  const auto u = test_support::random_signal(3, 1200, kOscillatorStep, 0.3, 6, 30);
  with(u, answer(u, [](double, double) { return 0.0; }));
  const auto drive = relation_->prepare(case_.records[0]);
  const auto& base = relation_->base();
  int checked = 0;
  for (const auto& candidate : relation_->candidates(relation_->base())) {
    // The differences of these are zero or jump.
    if (candidate.kind == "quantisation" || candidate.kind == "overflow") continue;
    const Hypothesis hypothesis = extended(base, candidate, candidate.starts[0]);
    const auto simulator = relation_->simulator(hypothesis, *drive);
    std::vector<Index> wanted;
    for (Index i = 0; i < hypothesis.values.size(); ++i) wanted.push_back(i);
    MatrixXd prediction, above, below;
    std::vector<MatrixXd> derivatives, none;
    ASSERT_TRUE(simulator->run(hypothesis.values, wanted, prediction, derivatives))
        << candidate.name;
    for (const Index i : wanted) {
      const double step = 1e-4 * hypothesis.free[static_cast<std::size_t>(i)].scale;
      VectorXd values = hypothesis.values;
      values[i] += step;
      ASSERT_TRUE(simulator->run(values, {}, above, none));
      values[i] -= 2 * step;
      ASSERT_TRUE(simulator->run(values, {}, below, none));
      const MatrixXd difference = (above - below) / (2 * step);
      const auto& derivative = derivatives[static_cast<std::size_t>(i)];
      // The prediction does not depend on the parameter.
      if (difference.norm() * step < 1e-12 * prediction.norm()) continue;
      EXPECT_LT(test_support::relative_error(derivative, difference), 0.02)
          << candidate.name << " at " << candidate.channel << ": "
          << hypothesis.free[static_cast<std::size_t>(i)].name;
      ++checked;
    }
  }
  EXPECT_GT(checked, 100);
}

TEST_F(Oscillator, ReportsErrorsInItsTable) {
  const std::vector<double> u(100, 1.0);
  folder_.write("fit.csv", {{"u", u}, {"y", u}});
  const auto error_with = [&](const std::string& before, const std::string& after) {
    std::string toml = kOscillatorCase;
    toml.replace(toml.find(before), before.size(), after);
    const auto message =
        test::error_of([&] { static_cast<void>(dynamic_relation(folder_.load(toml))); });
    const auto at = message.find("case.toml");
    return at == std::string::npos ? message : message.substr(at);
  };

  EXPECT_EQ(error_with("\"force.1\"", "\"force.2\""),
            "case.toml:18:13: '2' is not a mass, expected 1 to 1");
  EXPECT_EQ(
      error_with("\"displacement.1\"", "\"position.1\"")
          .find("case.toml:20:14: 'position.1' is not an output, expected displacement.<mass>"),
      0U);
  EXPECT_EQ(error_with("[0, 1]", "[0, 3]"),
            "case.toml:14:11: between must be two different numbers from 0, the ground, to 1, the "
            "last mass");
  EXPECT_EQ(error_with("\"mass.1\", ", "\"mass.4\", ")
                .find("case.toml:12:10: the model has no parameter 'mass.4'"),
            0U);
  EXPECT_EQ(error_with("masses_kg = [2.0]", "masses_kg = [-2.0]"),
            "case.toml:11:13: a mass is -2, expected more than 0");
  EXPECT_EQ(error_with("\"input.u\" =", "\"input.w\" ="),
            "fit.csv: the model needs the channel input.w, which was not recorded");
}

}  // namespace
}  // namespace rths::diagnosis
