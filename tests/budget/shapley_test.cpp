// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <numeric>
#include <set>

#include <gtest/gtest.h>

#include <rths/budget/shapley.hpp>
#include <rths/core/error.hpp>

namespace rths::budget {
namespace {

TEST(Shapley, AddsUpToTheValueOfAllPlayers) {
  const auto value = [](unsigned c) { return 0.3 * (c & 1U) + 0.7 * ((c & 6U) == 6U) - 0.2 * c; };
  const auto shares = shapley(4, value);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), value(15) - value(0), 1e-12);
}

TEST(Shapley, IsTheOwnValueInAnAdditiveGame) {
  const double own[] = {1, -2, 5, 0.5, 0};
  const auto shares = shapley(5, [&](unsigned c) {
    double sum = 7;  // of nobody
    for (unsigned i = 0; i < 5; ++i) sum += (c >> i & 1U) != 0 ? own[i] : 0;
    return sum;
  });
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(shares[i], own[i], 1e-12);
}

TEST(Shapley, IsEqualForSymmetricPlayersAndZeroForADummy) {
  // Any two of the first three win; the fourth changes nothing.
  const auto shares = shapley(4, [](unsigned c) { return std::popcount(c & 7U) >= 2 ? 1.0 : 0.0; });
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(shares[i], 1.0 / 3, 1e-12);
  EXPECT_EQ(shares[3], 0);
}

// Shapley's own example of 1953: one seller, two buyers.
TEST(Shapley, GivesTheOwnerOfTheGloveFourSixths) {
  const auto shares =
      shapley(3, [](unsigned c) { return (c & 1U) != 0 && (c & 6U) != 0 ? 1.0 : 0.0; });
  EXPECT_NEAR(shares[0], 4.0 / 6, 1e-12);
  EXPECT_NEAR(shares[1], 1.0 / 6, 1e-12);
  EXPECT_NEAR(shares[2], 1.0 / 6, 1e-12);
}

TEST(Shapley, RefusesNoPlayersAndTooMany) {
  const auto value = [](unsigned) { return 0.0; };
  EXPECT_THROW(static_cast<void>(shapley(0, value)), Error);
  EXPECT_THROW(static_cast<void>(shapley(17, value)), Error);
  EXPECT_THROW(static_cast<void>(shapley_from_ends(0, value)), Error);
}

// A quadratic form of the players that take part: no three interact.
double in_pairs(unsigned c) {
  const double own[] = {1, -2, 5, 0.5, 0};
  double sum = 3;
  for (unsigned i = 0; i < 5; ++i)
    for (unsigned k = 0; k < 5; ++k)
      if ((c >> i & 1U) != 0 && (c >> k & 1U) != 0) sum += own[i] * (own[k] + 0.1 * (i + k));
  return sum;
}

TEST(SharesFromEnds, AreExactIfPlayersInteractInPairs) {
  const auto all = shapley(5, in_pairs);
  const auto found = shapley_from_ends(5, in_pairs);
  EXPECT_NEAR(found.gap, 0, 1e-12);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_NEAR(found.shares[i], all[i], 1e-12);
}

TEST(SharesFromEnds, NeedTwoCoalitionsForEachPlayerAndTwoMore) {
  std::set<unsigned> valued;
  static_cast<void>(shapley_from_ends(6, [&](unsigned c) {
    valued.insert(c);
    return 1.0 * c;
  }));
  EXPECT_EQ(valued.size(), 14U);
}

// Three that only win together: each share is 1/3, but each alone adds 0 to nobody and 1 to the
// others.
TEST(SharesFromEnds, AddUpAndTellTheirGapIfThreeInteract) {
  const auto found = shapley_from_ends(4, [](unsigned c) { return (c & 7U) == 7U ? 1.0 : 0.0; });
  EXPECT_NEAR(found.gap, 1 - 1.5, 1e-12);
  EXPECT_NEAR(std::accumulate(found.shares.begin(), found.shares.end(), 0.0), 1, 1e-12);
}

}  // namespace
}  // namespace rths::budget
