// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include <gtest/gtest.h>

#include <rths/identification/constants.hpp>
#include <rths/identification/forms.hpp>
#include <rths/identification/relation_findings.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

constexpr Index kLawRows = 2000;
constexpr double kLawStep = 0.01;
constexpr double kNear = 0.05;               // [N] between straight lines and the law
constexpr double kFromRidge = 1 - kVisited;  // [-] of a value, at most

/// Two records of a motion, and a model of two terms "one" and "other".
struct TwoTerms {
  LinearRelation relation;
  std::vector<Record> records;

  // @param one, other  forces of the terms: functions of displacement and velocity
  // @param shape       of the motion over the sum of two sines
  template <class One, class Other>
  TwoTerms(
      const One& one, const Other& other, double (*shape)(double) = [](double u) { return u; }) {
    relation.stated = linear_model({"one", "other"}, {2, -3});
    for (const int i : {0, 1}) {
      const VectorXd u = (sine_of(20 + i, kLawRows) + sine_of(33 + i, kLawRows)).unaryExpr(shape);
      VectorXd v = VectorXd::Zero(kLawRows);
      for (Index row = 1; row + 1 < kLawRows; ++row)
        v[row] = (u[row + 1] - u[row - 1]) / (2 * kLawStep);
      VectorXd of_one(kLawRows), of_other(kLawRows);
      for (Index row = 0; row < kLawRows; ++row) {
        of_one[row] = one(u[row], v[row]);
        of_other[row] = other(u[row], v[row]);
      }
      records.push_back(linear_record("record", Use::Fit, kLawStep, gauss(kLawRows, 1, 1),
                                      {{"one", of_one}, {"other", of_other}}));
      records.back().channels.push_back({"auxiliary.displacement", "m", {u.begin(), u.end()}});
      records.back().channels.push_back({"auxiliary.velocity", "m/s", {v.begin(), v.end()}});
    }
  }

  [[nodiscard]] std::optional<Description> law() const {
    const Problem problem = linear_problem(relation, records);
    return common_law({problem, relation.stated}, {problem, linear_model({}, {})});
  }
};

TEST(CommonLaw, OfTwoFunctionsOfTheDisplacementIsTheirSum) {
  const auto cubic = [](double u, double) { return u * u * u; };
  const auto bent = [](double u, double) { return std::tanh(2 * u); };

  const auto law = TwoTerms{cubic, bent}.law();

  ASSERT_TRUE(law);
  EXPECT_EQ(law->form, "f(u)");
  EXPECT_GT(law->share, 0.99);
  ASSERT_EQ(law->x.size(), law->y.size());
  for (std::size_t i = 0; i < law->x.size(); ++i) {
    const double sum = 2 * cubic(law->x[i], 0) - 3 * bent(law->x[i], 0);
    EXPECT_NEAR(law->y[i], sum, kNear + kFromRidge * std::abs(sum)) << law->x[i];
  }
}

TEST(CommonLaw, OfTwoFunctionsOfTheVelocityIsOne) {
  const auto law = TwoTerms{
      [](double, double v) { return v * std::abs(v) / 100; },
      [](double, double v) {
        return std::tanh(v);
      }}.law();

  ASSERT_TRUE(law);
  EXPECT_EQ(law->form, "f(v)");
  EXPECT_EQ(law->x_label, "velocity [m/s]");
}

TEST(CommonLaw, EndsWhereNoRecordMoves) {
  const auto spring = [](double u, double) { return 4 * u; };
  const auto cubic = [](double u, double) { return u * u * u; };
  // From 0 to 1 and beyond 1.5.
  const auto gap = [](double u) { return std::abs(u) + (std::abs(u) > 1 ? 0.5 : 0); };

  const auto law = TwoTerms{spring, cubic, gap}.law();

  ASSERT_TRUE(law);
  EXPECT_TRUE(law->is_of_terms);
  ASSERT_GT(law->x.size(), 20U);
  for (std::size_t i = 0; i < law->x.size(); ++i) {
    const double u = law->x[i], knot = 0.07;  // [m] between two knots: a little less
    const double force = 8 * u - 3 * u * u * u;
    EXPECT_TRUE((u > -knot && u < 1 + knot) || u > 1.5 - knot) << u;
    EXPECT_NEAR(law->y[i], force, kNear + kFromRidge * std::abs(force)) << u;
  }
}

TEST(CommonLaw, IsNoneOfSpringAndFriction) {
  EXPECT_FALSE((TwoTerms{
      [](double u, double) { return u * u * u; },
      [](double, double v) {
        return 3 * std::tanh(v);
      }}.law()));
}

// The signal of the parameter is the sum of those of the candidate's two sizes.
TEST(RelationFindings, KeepsAStatedParameterThatANamedTermCanReplace) {
  std::vector<Record> records;
  for (const int i : {0, 1, 2}) {
    const VectorXd signal = sine_of(3 + i, kLawRows), up = signal.cwiseMax(0);
    records.push_back(linear_record("record " + std::to_string(i), i == 0 ? Use::Fit : Use::HeldOut,
                                    kLawStep,
                                    signal + 2 * up + gauss(kLawRows, 1, 40 + unsigned(i)),
                                    {{"stiffness", signal},
                                     {"x.forward_coefficient", up},
                                     {"x.backward_coefficient", signal.cwiseMin(0)}}));
  }
  auto relation = std::make_unique<LinearRelation>();
  relation->stated = linear_model({"stiffness"}, {1});
  Candidate candidate = friction("x");
  candidate.adds = {{{"asymmetric_viscous", "x", {}}, ""}};
  candidate.frees = {size_parameter("x.forward_coefficient"),
                     size_parameter("x.backward_coefficient")};
  candidate.starts = {VectorXd::Zero(2)};
  candidate.price = 2;
  relation->known = {candidate};
  std::vector<const Record*> all;
  for (const auto& record : records) all.push_back(&record);
  const SensorNoise noise{all, {{"output.0", 1}}};
  DiagnosisProgress progress;

  const auto found = examine(std::move(relation), records, noise, 1, progress);

  ASSERT_TRUE(found->is_named());
  const auto& named = found->selection.named;
  ASSERT_EQ(named.free.size(), 3U);
  EXPECT_EQ(named.values[0], 1);
  EXPECT_NEAR(named.values[1], 2, 0.2);  // 4 deviations of 1/√(rows/2)
  EXPECT_NEAR(named.values[2], 0, 0.2);
}

// Two functions of the displacement: one law of two terms, but none of a term and a sensor.
TEST(RelationFindings, HaveNoCommonLawOfATermAndASensor) {
  for (const Part part : {Part::Structure, Part::Sensor}) {
    std::vector<Record> records;
    for (const int i : {0, 1, 2}) {
      const VectorXd u = sine_of(20 + i, kLawRows) + sine_of(33 + i, kLawRows);
      const VectorXd cubic = u.array().cube(), bent = (2 * u).array().tanh();
      records.push_back(linear_record("record " + std::to_string(i),
                                      i == 0 ? Use::Fit : Use::HeldOut, kLawStep,
                                      2 * cubic - 3 * bent + gauss(kLawRows, 1, 40 + unsigned(i)),
                                      {{"cubic.coefficient", cubic}, {"bent.coefficient", bent}}));
      records.back().channels.push_back({"auxiliary.displacement", "m", {u.begin(), u.end()}});
      records.back().channels.push_back(
          {"auxiliary.velocity", "m/s", std::vector<double>(std::size_t(kLawRows))});
    }
    auto relation = std::make_unique<LinearRelation>();
    relation->known = {friction("cubic"), friction("bent")};
    relation->known[1].part = part;
    std::vector<const Record*> all;
    for (const auto& record : records) all.push_back(&record);
    const SensorNoise noise{all, {{"output.0", 1}}};
    DiagnosisProgress progress;

    const auto found = examine(std::move(relation), records, noise, 1, progress);

    EXPECT_EQ(found->selection.rounds.size(), 2U);
    EXPECT_EQ(found->common_law.has_value(), part == Part::Structure);
  }
}

}  // namespace
}  // namespace rths::diagnosis
