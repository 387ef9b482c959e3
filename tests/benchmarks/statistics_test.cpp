// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/statistics.hpp>

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace rths::bench {
namespace {

std::vector<double> counted_to(int last) {
  std::vector<double> values(static_cast<std::size_t>(last));
  std::iota(values.begin(), values.end(), 1.0);
  return values;
}

double binomial(int n, int k) {
  return std::round(std::exp(std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1)));
}

// For n values drawn from 1…n with replacement, n odd: their median is at most k if more than half
// of them are at most k.
double chance_of_median_up_to(int k, int n) {
  const double p = static_cast<double>(k) / n;
  double chance = 0;
  for (int drawn = n / 2 + 1; drawn <= n; ++drawn)
    chance += binomial(n, drawn) * std::pow(p, drawn) * std::pow(1 - p, n - drawn);
  return chance;
}

TEST(Median, IsTheMiddleOfAnOddNumberOfValues) { EXPECT_EQ(median({9, 1, 5}), 5); }

TEST(Median, IsTheMeanOfTheTwoMiddleOnesOfAnEvenNumber) { EXPECT_EQ(median({9, 1, 5, 2}), 3.5); }

TEST(Quantile, OfOneValueIsThatValue) {
  for (const double fraction : {0.0, 0.5, 0.99, 1.0}) EXPECT_EQ(quantile({7}, fraction), 7);
}

TEST(Quantile, IsInterpolatedBetweenNeighbours) {
  // Of 1…n, the quantile at p is 1 + p (n − 1).
  for (const double fraction : {0.0, 0.01, 0.25, 0.5, 0.99, 1.0})
    EXPECT_NEAR(quantile(counted_to(11), fraction), 1 + fraction * 10, 1e-12);
}

TEST(Times, HaveMedianAndTailOfTheSameValues) {
  const Times times = times_of(counted_to(101));

  EXPECT_DOUBLE_EQ(times.p50, 51);
  EXPECT_DOUBLE_EQ(times.p99, 100);
}

TEST(Times, HaveTheMedianOfEachQuantile) {
  const Times middle = median(std::vector<Times>{{1, 30}, {2, 10}, {9, 20}});

  EXPECT_EQ(middle.p50, 2);
  EXPECT_EQ(middle.p99, 20);
}

TEST(Bootstrap, GivesTheValueItselfIfAllAreEqual) {
  const Interval interval = median_interval({3, 3, 3, 3, 3}, 1);

  EXPECT_EQ(interval.low, 3);
  EXPECT_EQ(interval.high, 3);
}

TEST(Bootstrap, MatchesTheExactDistributionOfTheMedian) {
  for (const int n : {5, 9, 15}) {
    int low = 1;
    while (chance_of_median_up_to(low, n) < 0.025) ++low;

    const Interval interval = median_interval(counted_to(n), 1);

    EXPECT_EQ(interval.low, low) << n;
    EXPECT_EQ(interval.high, n + 1 - low) << n;  // by symmetry
  }
}

TEST(Bootstrap, IsRepeatedByItsSeed) {
  const std::vector<double> values{1.0, 1.4, 1.1, 0.9, 1.2, 1.3};

  const Interval first = median_interval(values, 42);
  const Interval second = median_interval(values, 42);

  EXPECT_EQ(first.low, second.low);
  EXPECT_EQ(first.high, second.high);
}

}  // namespace
}  // namespace rths::bench
