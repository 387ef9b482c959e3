// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <numeric>

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
}

}  // namespace
}  // namespace rths::budget
