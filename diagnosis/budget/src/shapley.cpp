// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/shapley.hpp>

#include <bit>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::budget {
namespace {

constexpr std::size_t kMostPlayers = 16;

void check(std::size_t players) {
  if (players < 1 || players > kMostPlayers)
    throw Error{fmt::format("a budget has {} parts, expected 1 to {}", players, kMostPlayers)};
}

// Share of the orders of n players in which exactly s given players precede a given one:
// s! (n − 1 − s)! / n!, for s = 0 … n − 1.
std::vector<double> weights_of(std::size_t n) {
  std::vector<double> weights(n);
  weights[0] = 1.0 / static_cast<double>(n);
  for (std::size_t s = 1; s < n; ++s)
    weights[s] = weights[s - 1] * static_cast<double>(s) / static_cast<double>(n - s);
  return weights;
}

}  // namespace

std::vector<double> shapley(std::size_t players,
                            const std::function<double(unsigned coalition)>& value) {
  check(players);
  const unsigned coalitions = 1U << players;
  std::vector<double> values(coalitions);
  for (unsigned coalition = 0; coalition < coalitions; ++coalition)
    values[coalition] = value(coalition);
  const auto weights = weights_of(players);
  std::vector<double> shares(players, 0.0);
  for (unsigned coalition = 0; coalition < coalitions; ++coalition)
    for (std::size_t player = 0; player < players; ++player) {
      const unsigned joined = coalition | 1U << player;
      if (joined == coalition) continue;
      const auto others = static_cast<std::size_t>(std::popcount(coalition));
      shares[player] += weights[others] * (values[joined] - values[coalition]);
    }
  return shares;
}

SharesFromEnds shapley_from_ends(std::size_t players,
                                 const std::function<double(unsigned coalition)>& value) {
  check(players);
  const unsigned everyone = (1U << players) - 1;
  const double none = value(0), all = value(everyone);
  SharesFromEnds found;
  found.gap = all - none;
  for (std::size_t player = 0; player < players; ++player) {
    const unsigned alone = 1U << player;
    found.shares.push_back((value(alone) - none + all - value(everyone & ~alone)) / 2);
    found.gap -= found.shares.back();
  }
  for (double& share : found.shares) share += found.gap / static_cast<double>(players);
  return found;
}

}  // namespace rths::budget
