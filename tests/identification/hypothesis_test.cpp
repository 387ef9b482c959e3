// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/hypothesis.hpp>

#include <gtest/gtest.h>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::VectorXd;

TEST(Hypothesis, NamesTheParameterOfATerm) {
  EXPECT_EQ(last_name("bouc_wen.eta"), "eta");
  EXPECT_EQ(last_name("spring.2.stiffness"), "stiffness");
  EXPECT_EQ(last_name("mass"), "mass");
}

TEST(Candidates, AreTheSameIfNameAndChannelAreTheSame) {
  Candidate one = friction("gain"), other = friction("gain");
  EXPECT_TRUE(is_same(one, other));

  other.channel = "force";
  EXPECT_FALSE(is_same(one, other));
  EXPECT_FALSE(is_same(one, friction("drag")));
}

TEST(Candidates, DependOnATermThatTheyChange) {
  const Candidate drag = friction("drag");
  Candidate other;
  EXPECT_FALSE(depends_on(other, drag));

  other.becomes = {{"drag", "quadratic_drag"}};
  EXPECT_TRUE(depends_on(other, drag));
  EXPECT_FALSE(depends_on(other, friction("dragging")));
}

TEST(Candidates, DependOnATermOfWhichTheyFreeAParameter) {
  const Candidate drag = friction("drag");
  Candidate other;
  other.frees = {size_parameter("drag.exponent")};
  EXPECT_TRUE(depends_on(other, drag));

  other.frees = {size_parameter("drag.2.exponent")};  // of a component with this name
  EXPECT_FALSE(depends_on(other, drag));
  EXPECT_FALSE(depends_on(drag, drag));  // its own term
}

TEST(ExtendedHypothesis, HasTermsAndStartOfTheCandidate) {
  const Hypothesis base = linear_model({"mass"}, {7});

  const Hypothesis result = extended(base, friction("drag"), VectorXd::Constant(1, 3));

  ASSERT_EQ(result.terms.size(), 1U);
  EXPECT_EQ(result.terms[0].settings.name, "drag");
  ASSERT_EQ(result.free.size(), 2U);
  EXPECT_EQ(result.free[1].name, "drag.coefficient");
  EXPECT_EQ(result.values, (VectorXd{{7, 3}}));
}

TEST(ExtendedHypothesis, ReplacesTheKindOfATerm) {
  const Hypothesis base = extended(linear_model({}, {}), friction("drag"), VectorXd::Zero(1));
  Candidate other;
  other.becomes = {{"drag", "quadratic_drag"}};

  EXPECT_EQ(extended(base, other, {}).terms[0].settings.kind, "quadratic_drag");
}

TEST(ExtendedHypothesis, KeepsValuesOfKnownParameters) {
  const Hypothesis base = linear_model({"mass"}, {7});
  Candidate candidate;
  candidate.frees = {size_parameter("mass", -5, 5), size_parameter("stiffness")};

  const Hypothesis result = extended(base, candidate, VectorXd{{1, 2}});

  EXPECT_EQ(result.values, (VectorXd{{7, 2}}));
  EXPECT_EQ(result.free[0].high, base.free[0].high);
}

TEST(ExtendedHypothesis, WidensATolerance) {
  Hypothesis base = linear_model({"delay"}, {0.1});
  base.free[0].is_tolerance = true;
  Candidate candidate;
  candidate.frees = {size_parameter("delay", -1e6, 1e6)};

  const Hypothesis result = extended(base, candidate, VectorXd::Zero(1));

  ASSERT_EQ(result.free.size(), 1U);
  EXPECT_EQ(result.free[0].high, 1e6);
  EXPECT_EQ(result.values[0], 0.1);
}

TEST(TakeValues, CopiesParametersOfTheSameNameOnly) {
  Hypothesis to = linear_model({"a", "b", "c"}, {1, 2, 3});

  take_values(linear_model({"c", "x", "a"}, {30, 40, 10}), to);

  EXPECT_EQ(to.values, (VectorXd{{10, 2, 30}}));
}

TEST(MayExtend, RefusesAKindThatLacksAFreedParameter) {
  const Hypothesis base = extended(linear_model({}, {}), friction("drag"), VectorXd::Zero(1));
  Candidate other = friction("brake");
  EXPECT_TRUE(may_extend(base, other));

  other.becomes = {{"drag", "coulomb_friction"}};
  EXPECT_FALSE(may_extend(base, other));
}

}  // namespace
}  // namespace rths::diagnosis
