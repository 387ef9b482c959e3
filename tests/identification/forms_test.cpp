// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/forms.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include <rths/identification/pruning.hpp>

#include "form_search.hpp"
#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kFormRows = 4000;
constexpr double kFormStep = 0.01;

/// A measured motion of three incommensurate frequencies, and its exact velocity.
struct Motion {
  VectorXd u{kFormRows}, v{kFormRows};

  explicit Motion(double phase) {
    u.setZero();
    v.setZero();
    for (const double frequency : {0.31, 0.73, 1.13})
      for (Index i = 0; i < kFormRows; ++i) {
        const double w = 2 * std::numbers::pi * frequency;
        const double angle = w * double(i) * kFormStep + phase * (1 + frequency);
        u[i] += std::sin(angle) / w;
        v[i] += std::cos(angle);
      }
  }
};

using Law = std::function<VectorXd(const Motion&)>;

/// Two records of force = 3 u + law(u, v) + noise in some unit, and a model that knows 3 u.
class Forms : public ::testing::Test {
 protected:
  static constexpr double kFormNoise = 0.02;

  void measure(const Law& law, double unit = 1) {
    relation.stated = linear_model({"stiffness"}, {3});
    relation.deviation = {kFormNoise * unit};
    records.clear();
    for (const unsigned i : {0U, 1U}) {
      const Motion motion{0.4 + i};
      records.push_back(linear_record(
          "record", Use::Fit, kFormStep,
          unit * (3 * motion.u + law(motion) + kFormNoise * gauss(kFormRows, 1, 1 + i)),
          {{"stiffness", unit * motion.u}}));
      records.back().channels.push_back(
          {"auxiliary.displacement", "m", {motion.u.begin(), motion.u.end()}});
      records.back().channels.push_back(
          {"auxiliary.velocity", "m/s", {motion.v.begin(), motion.v.end()}});
    }
  }
  [[nodiscard]] std::vector<Description> described() const {
    const Problem problem = linear_problem(relation, records);
    return describe(TestedHypothesis{problem, relation.stated}, two_records());
  }

  // Of a form whose name begins so.
  [[nodiscard]] double share_of(const std::string& form) const {
    for (const auto& one : described())
      if (one.form.starts_with(form)) return one.share;
    ADD_FAILURE() << form << " was not tried";
    return 0;
  }

  LinearRelation relation;
  std::vector<Record> records;
};

VectorXd drag(const Motion& motion) { return motion.v.array() * motion.v.array().abs(); }

// The share of a form is never relative to less than a twentieth of the noise: 81 free values of a
// surface explain about 81 of 4000 squares of noise where they are fitted, and less elsewhere.
TEST_F(Forms, ExplainNothingOfNoise) {
  measure([](const Motion& motion) -> VectorXd { return 0 * motion.u; });

  for (const auto& form : described()) EXPECT_LT(form.share, 0.3) << form.form;
}

// Knots at velocities v_k = 0.05 V sinh(asinh(20) (k - 9)/9). Between the outer ones, V/3 apart, a
// parabola differs from its chord by up to (V/3)²/4, so that a fitted knot is off by no more.
TEST_F(Forms, RecoverAForceOverTheVelocity) {
  measure(drag);

  const auto found = described();

  ASSERT_FALSE(found.empty());
  const Description& best = found[0];
  EXPECT_EQ(best.form, "f(v)");
  EXPECT_EQ(best.x_label, "velocity [m/s]");
  EXPECT_GT(best.share, 0.98);
  EXPECT_LE(best.share, 1);
  ASSERT_EQ(best.x.size(), 19U);
  const double reach = best.x.back();
  EXPECT_NEAR(reach,
              std::max(Motion{0.4}.v.cwiseAbs().maxCoeff(), Motion{1.4}.v.cwiseAbs().maxCoeff()),
              1e-9);
  for (std::size_t i = 1; i + 1 < best.x.size(); ++i) {
    const double width = std::max(best.x[i + 1] - best.x[i], best.x[i] - best.x[i - 1]);
    EXPECT_NEAR(best.y[i], best.x[i] * std::abs(best.x[i]), width * width / 4 + 4 * best.band[i])
        << best.x[i];
  }
}

TEST_F(Forms, RecoverAFrictionThatDependsOnTheDisplacement) {
  const double reach = Motion{0.4}.u.cwiseAbs().maxCoeff();
  measure([&](const Motion& motion) -> VectorXd {
    return motion.v.array().sign() * (1 + (2 * motion.u.array() / reach).square());
  });

  const auto found = described();

  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].form, "sgn(v) g(u)");
  EXPECT_EQ(found[0].x_label, "displacement [m]");
}

TEST_F(Forms, DoNotDependOnTheUnitOfTheOutput) {
  measure(drag);
  const auto one = described();
  measure(drag, 1e6);
  const auto other = described();

  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].form, other[i].form);
    EXPECT_NEAR(one[i].share, other[i].share, 1e-6) << one[i].form;
  }
  for (std::size_t i = 0; i < one[0].y.size(); ++i)
    EXPECT_NEAR(other[0].y[i], 1e6 * one[0].y[i], 1e-3 * (1e6 * std::abs(one[0].y[i]) + 1e3));
}

TEST_F(Forms, NameAnExternalPeriodicForce) {
  measure([](const Motion&) -> VectorXd { return sine_of(280, kFormRows); });  // 7 Hz

  const auto found = described();

  ASSERT_FALSE(found.empty());
  EXPECT_TRUE(found[0].form.starts_with("external periodic force at ")) << found[0].form;
  EXPECT_NEAR(std::stod(found[0].form.substr(27)), 7, 0.01);
  EXPECT_GT(found[0].share, 0.98);
}

// Twenty cycles after a push, a resonance of 3 % damping has lost its phase: exp(-0.03 2π 20) = 2
// %.
TEST_F(Forms, DoNotTakeAResonanceUnderRandomForcesForAnExternalForce) {
  unsigned seed = 100;
  measure([&](const Motion&) -> VectorXd {
    constexpr double kFrequency = 4, kDamping = 0.03;  // [Hz]
    const double w = 2 * std::numbers::pi * kFrequency;
    const VectorXd push = gauss(kFormRows, 1, ++seed);
    VectorXd x = VectorXd::Zero(kFormRows);
    double rate = 0;
    for (Index i = 1; i < kFormRows; ++i) {
      rate += kFormStep * (20 * push[i] - 2 * kDamping * w * rate - w * w * x[i - 1]);
      x[i] = x[i - 1] + kFormStep * rate;
    }
    return x;
  });

  EXPECT_LT(share_of("external periodic force"), 0.2);
}

// Pieces of 0.1 s every 2.3 s in which the output keeps its value.
TEST_F(Forms, NameSamplesThatAreHeld) {
  measure([](const Motion& motion) -> VectorXd {
    VectorXd change = VectorXd::Zero(kFormRows);
    for (Index begin = 100; begin + 10 < kFormRows; begin += 230)
      for (Index i = begin; i < begin + 10; ++i)
        change[i] = 3 * (motion.u[begin - 1] - motion.u[i]);
    return change;
  });

  const auto found = described();

  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].form, "held samples");
  EXPECT_GT(found[0].share, 0.9);
  EXPECT_LE(found[0].share, 1.05);
}

// Also if they are longer than the longest piece that is tried, as several pieces.
TEST(HeldSamples, OfALongRecordAreFound) {
  constexpr Index kRows = 60'000;
  const VectorXd motion = sine_of(31, kRows);
  for (const Index length : {900, 1150}) {
    LinearRelation relation;
    relation.stated = linear_model({"stiffness"}, {3});
    relation.deviation = {0.02};
    VectorXd force = 3 * motion;
    for (Index begin = 2000; begin + length < kRows; begin += 9000)
      force.segment(begin, length).setConstant(force[begin - 1]);
    std::vector<Record> records{linear_record(
        "record", Use::Fit, 1e-3, force + 0.02 * gauss(kRows, 1, 1), {{"stiffness", motion}})};
    const Problem problem = linear_problem(relation, records);
    std::vector<Description> found;

    find_held_samples(TestedHypothesis{problem, relation.stated}, {{}, {}, whole({0})}, found);

    ASSERT_EQ(found.size(), 1U);
    EXPECT_GT(found[0].share, 0.9) << length;
    EXPECT_LE(found[0].share, 1) << length;
  }
}

TEST_F(Forms, DoNotTakeASaturatedSensorForHeldSamples) {
  measure([](const Motion& motion) -> VectorXd {
    const double limit = 0.7 * motion.u.cwiseAbs().maxCoeff();
    return 3 * (motion.u.cwiseMax(-limit).cwiseMin(limit) - motion.u);
  });

  EXPECT_LT(share_of("held samples"), 0.1);
}

// The measurement stays on its plateau for a tenth of a record, and leaves it as it came.
TEST(HeldSamples, AreNoPlateau) {
  constexpr Index kRows = 4000;
  const VectorXd motion = VectorXd::LinSpaced(kRows, 0, 4);
  LinearRelation relation;
  relation.stated = linear_model({"stiffness"}, {3});
  relation.deviation = {0.02};
  const VectorXd force =
      (3 * motion).cwiseMin(6) + (3 * motion).cwiseMax(7.2) - VectorXd::Constant(kRows, 7.2);
  std::vector<Record> records{linear_record(
      "record", Use::Fit, 1e-3, force + 0.02 * gauss(kRows, 1, 1), {{"stiffness", motion}})};
  const Problem problem = linear_problem(relation, records);
  std::vector<Description> found;

  find_held_samples(TestedHypothesis{problem, relation.stated}, {{}, {}, whole({0})}, found);

  ASSERT_EQ(found.size(), 1U);
  EXPECT_LT(found[0].share, 0.1);
}

// A relaxation lags behind a sine, so that its residual is a sine of the test itself.
TEST(ExternalForce, IsNotThatOfAPeriodicTest) {
  constexpr Index kRows = 4000;
  const VectorXd motion = sine_of(40, kRows);
  LinearRelation relation;
  relation.stated = linear_model({"stiffness"}, {3});
  VectorXd lag(kRows);
  for (Index i = 0; i < kRows; ++i) lag[i] = 10 * motion[(i + 25) % kRows];
  std::vector<Record> records;
  for (const unsigned seed : {1U, 2U})
    records.push_back(linear_record("record " + std::to_string(seed), Use::Fit, 1e-3,
                                    3 * motion + lag + gauss(kRows, 1, seed),
                                    {{"stiffness", motion}}));
  const Problem problem = linear_problem(relation, records);
  std::vector<Description> found;

  find_periodic_force(TestedHypothesis{problem, relation.stated}, two_records(), found);

  EXPECT_TRUE(found.empty());
}

TEST_F(Forms, DoNotTakeADelayForHeldSamples) {
  measure([](const Motion& motion) -> VectorXd {
    constexpr Index kDelay = 4;  // [rows]
    VectorXd change = VectorXd::Zero(kFormRows);
    for (Index i = kDelay; i < kFormRows; ++i) change[i] = 3 * (motion.u[i - kDelay] - motion.u[i]);
    return change;
  });

  EXPECT_LT(share_of("held samples"), 0.1);
}

// Linear in the path, so that knots are exact but for the fixed width of the reversal.
TEST_F(Forms, RecoverAFrictionThatGrowsWithThePath) {
  measure([](const Motion& motion) -> VectorXd {
    VectorXd path = motion.v.cwiseAbs() * kFormStep;
    for (Index i = 1; i < kFormRows; ++i) path[i] += path[i - 1];
    return path.array() * motion.v.array().sign();
  });

  const auto found = described();

  ASSERT_FALSE(found.empty());
  const Description& best = found[0];
  EXPECT_EQ(best.form, "sgn(v) g(path)");
  EXPECT_EQ(best.x_label, "path [m]");
  EXPECT_GT(best.share, 0.98);
  for (std::size_t i = 0; i < best.x.size(); ++i)
    EXPECT_NEAR(best.y[i], best.x[i], 0.02 * best.x.back()) << best.x[i];
}

// Presliding over half of the longest distance that is tried. The blend of the shortest and the
// longest differs from it while the friction turns, a tenth of the time, by up to a quarter.
TEST_F(Forms, RecoverAFrictionWithPresliding) {
  measure([](const Motion& motion) -> VectorXd {
    const double presliding = 0.005 * motion.u.cwiseAbs().maxCoeff();
    VectorXd force = VectorXd::Zero(kFormRows);
    double direction = 0, path = 0;
    for (Index i = 1; i < kFormRows; ++i) {
      direction = std::clamp(direction + (motion.u[i] - motion.u[i - 1]) / presliding, -1.0, 1.0);
      path += std::abs(motion.v[i]) * kFormStep;
      force[i] = direction * (10 + path);
    }
    return force;
  });

  const auto found = described();

  ASSERT_FALSE(found.empty());
  const Description& best = found[0];
  EXPECT_EQ(best.form, "sgn(v) g(path)");
  EXPECT_GT(best.share, 0.95);
  for (std::size_t i = 0; i < best.x.size(); ++i)
    EXPECT_NEAR(best.y[i], 10 + best.x[i], 0.05 * best.y.back()) << best.x[i];
}

// Each record prefers another stiffness. That is no part of the form, which both share.
TEST_F(Forms, DoNotDependOnParametersThatDifferFromRecordToRecord) {
  double error = 0.1;
  measure([&](const Motion& motion) -> VectorXd {
    error = -error;
    return 0.3 * drag(motion) + error * motion.u;
  });

  const auto found = described();

  ASSERT_FALSE(found.empty());
  EXPECT_EQ(found[0].form, "f(v)");
  EXPECT_GT(found[0].share, 0.9);
}

TEST_F(Forms, NameTheChangeOfAParameter) {
  measure([](const Motion& motion) -> VectorXd {
    VectorXd force = 2 * motion.u;
    force.head(2000).setZero();
    return force;
  });

  const auto found = described();

  const auto change = std::find_if(found.begin(), found.end(), [](const auto& one) {
    return one.form.starts_with("change of stiffness at ");
  });
  ASSERT_NE(change, found.end());
  EXPECT_NEAR(std::stod(change->form.substr(23)), 20, 0.7);  // tried every 0.66 s
  EXPECT_GT(change->share, 0.9);
  EXPECT_EQ(found[0].form, change->form);
}

/// Candidates that were selected beside an unknown force.
class FormRivals : public Forms {
 protected:
  void measure_with(const Law& law, const std::map<std::string, Law>& candidates) {
    measure(law);
    for (std::size_t i = 0; i < records.size(); ++i) {
      const Motion motion{0.4 + static_cast<double>(i)};
      for (const auto& [name, of] : candidates) {
        const VectorXd signal = of(motion);
        records[i].channels.push_back(
            {"input." + name + ".coefficient.0", "N", {signal.begin(), signal.end()}});
      }
    }
    selection.base = selection.named = relation.stated;
    for (const auto& [name, of] : candidates) {
      const Candidate candidate = friction(name);
      selection.named = extended(selection.named, candidate, candidate.starts[0]);
      selection.rounds.push_back({{candidate, selection.named, 0, {}, 0, 0, 0}, {}, {}});
    }
  }
  void give_shapes() {
    for (auto& round : selection.rounds)
      for (auto& free : round.chosen.candidate.frees) free.absent.reset();
  }
  [[nodiscard]] std::string withdrawn(bool for_law = false) {
    Problem problem = linear_problem(relation, records);
    const Folds folds = two_records();
    finish(problem, folds, selection);
    const auto forms = describe(TestedHypothesis{problem, selection.named}, folds);
    const auto one = for_law ? withdraw_for_law(problem, folds, selection)
                             : withdraw_for_form(problem, folds, forms, selection);
    return one ? one->candidate.name : "none";
  }

  Selection selection;
};

VectorXd cogs(const Motion& motion) { return (12 * motion.u.array()).sin() + 0.3; }
VectorXd cube(const Motion& motion) { return motion.u.array().cube(); }

// A cube of the displacement fits the sine of the displacement in part. So does a force over the
// displacement, which fits the rest, too.
TEST_F(FormRivals, AreWithdrawnIfTheFormExplainsThemToo) {
  measure_with(cogs, {{"cube", cube}});

  EXPECT_EQ(withdrawn(), "cube");
  EXPECT_TRUE(selection.rounds.empty());
  EXPECT_EQ(selection.named.free.size(), 1U);
}

// No force over the displacement explains a drag.
TEST_F(FormRivals, StayIfTheFormDoesNotExplainThem) {
  measure_with([](const Motion& motion) -> VectorXd { return cogs(motion) + 0.2 * drag(motion); },
               {{"drag", drag}});

  EXPECT_EQ(withdrawn(), "none");
}

// Then the form is that of the candidate's small error.
TEST_F(FormRivals, StayIfTheyExplainMoreThanTheForm) {
  measure_with(
      [](const Motion& motion) -> VectorXd { return cube(motion) * 30 + 0.1 * cogs(motion); },
      {{"cube", cube}});

  EXPECT_EQ(withdrawn(), "none");
}

// A curve over the displacement leaves nothing, but a size only is an idealisation.
TEST_F(FormRivals, OfAFittedShapeAreWithdrawnIfACurveLeavesFarLess) {
  measure_with(
      [](const Motion& motion) -> VectorXd { return cube(motion) * 3 + 0.5 * cogs(motion); },
      {{"cube", cube}});
  EXPECT_EQ(withdrawn(true), "none");

  give_shapes();

  EXPECT_EQ(withdrawn(true), "cube");
  EXPECT_TRUE(selection.rounds.empty());
}

// What the cube leaves is another effect, which no curve over the displacement contains.
TEST_F(FormRivals, StayIfNoCurveContainsWhatTheyLeave) {
  measure_with(
      [](const Motion& motion) -> VectorXd { return 30 * cube(motion) + 0.2 * drag(motion); },
      {{"cube", cube}});
  give_shapes();

  EXPECT_EQ(withdrawn(true), "none");
}

}  // namespace
}  // namespace rths::diagnosis
