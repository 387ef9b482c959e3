// SPDX-License-Identifier: Apache-2.0
//
// A fit may fail because a model has no prediction. Any other exception is a bug of the program.
#include <stdexcept>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

#include "identification/linear_relation.hpp"

namespace rths::diagnosis {
namespace {

/// A line of slope 2, and the simulation's of slope 1.
class FailedFit : public ::testing::Test {
 protected:
  static LinearRelation line() {
    LinearRelation relation;
    relation.stated = linear_model({"slope"}, {1});
    relation.deviation = {0.01};
    return relation;
  }
  [[nodiscard]] std::optional<Fit> fit() const {
    return fit_if_possible(problem, relation.base(), whole({0}), kShortFit);
  }

  const Eigen::VectorXd rising = Eigen::VectorXd::LinSpaced(40, 0, 1);
  const std::vector<Record> records{
      linear_record("line", Use::Fit, 0.1, 2 * rising, {{"slope", rising}})};
  LinearRelation relation = line();
  Problem problem = linear_problem(relation, records);
};

TEST_F(FailedFit, IsAFitIfThereIsAPrediction) {
  const auto fitted = fit();

  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->parameters[0], 2, 1e-6);
}

TEST_F(FailedFit, IsNoneIfTheModelHasNoPrediction) {
  relation.fail = [] { throw Error{"it diverges"}; };

  EXPECT_FALSE(fit());
}

TEST_F(FailedFit, DoesNotHideABug) {
  relation.fail = [] { throw std::out_of_range{"an index"}; };

  EXPECT_THROW(static_cast<void>(fit()), std::out_of_range);
}

}  // namespace
}  // namespace rths::diagnosis
