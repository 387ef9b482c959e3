// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rths/maths/statistics.hpp>

namespace rths::maths {
namespace {

TEST(Statistics, OfAFewValuesAreThoseByHand) {
  const std::vector<double> values{1, 2, 6};

  EXPECT_DOUBLE_EQ(mean(values), 3);
  EXPECT_DOUBLE_EQ(rms(values), std::sqrt(41.0 / 3));
  EXPECT_DOUBLE_EQ(deviation(values), std::sqrt(14.0 / 3));
  EXPECT_EQ(steps_of(values), (std::vector<double>{1, 4}));
}

TEST(Statistics, AreZeroWithoutValues) {
  EXPECT_EQ(mean({}), 0);
  EXPECT_EQ(rms({}), 0);
  EXPECT_EQ(deviation({}), 0);
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_TRUE(steps_of({}).empty());
}

TEST(Median, IsTheMiddleValueInRisingOrder) { EXPECT_EQ(median(std::vector{5.0, 1.0, 3.0}), 3); }

TEST(Median, OfAnEvenNumberIsTheLargerOfTheMiddleTwo) {
  EXPECT_EQ(median(std::vector{4, 1, 3, 2}), 3);
}

TEST(Median, OrdersPairsByTheirFirstValue) {
  EXPECT_EQ(median(std::vector<std::pair<double, int>>{{3, 30}, {1, 10}, {2, 20}}).second, 20);
}

TEST(Quantile, OfAHalfIsTheSmallerOfTheMiddleTwo) {
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(quantile({3, 1, 2}, 0.5), 2);
}

TEST(Quantile, ReachesFromTheSmallestToTheLargestValue) {
  EXPECT_EQ(quantile({3, 1, 2}, 0), 1);
  EXPECT_EQ(quantile({3, 1, 2}, 1), 3);
}

TEST(Quantile, IsTheValueAtTheShareOfTheRank) {
  std::vector<double> values(101);
  std::iota(values.rbegin(), values.rend(), 0);

  EXPECT_EQ(quantile(values, 0), 0);
  EXPECT_EQ(quantile(values, 0.05), 5);
  EXPECT_EQ(quantile(values, 0.5), 50);
  EXPECT_EQ(quantile(values, 1), 100);
  EXPECT_EQ(quantile({}, 0.5), 0);
}

}  // namespace
}  // namespace rths::maths
