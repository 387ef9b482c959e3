// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

namespace rths::budget {

/// Shapley values of a game: what each player adds, averaged over all orders in which the players
/// can join. They add up to the value of all players together less the value of none. Exact: every
/// coalition is valued once.
/// @param players  1 to 16
/// @param value  of a coalition; player i takes part if bit i is set
/// @returns one value per player   @throws Error if there are too few or too many players
/// @setup
/// Source: Shapley (1953), A value for n-person games.
[[nodiscard]] std::vector<double> shapley(std::size_t players,
                                          const std::function<double(unsigned coalition)>& value);

/// Shapley values from the ends of the game: no player, each alone, all but each, all.
struct SharesFromEnds {
  std::vector<double> shares;  ///< one per player; they add up as those of `shapley`
  /// What the shares, before they were made to add up, differed by. 0 if no three players interact.
  double gap = 0;
};

/// Half of what a player adds to nobody, half of what it adds to all others: exact if the value is
/// a sum of terms of one player and of two. 2 + 2 players coalitions are valued, at most once each.
/// @param players, value  as `shapley`   @throws Error as `shapley`   @setup
[[nodiscard]] SharesFromEnds shapley_from_ends(
    std::size_t players, const std::function<double(unsigned coalition)>& value);

}  // namespace rths::budget
