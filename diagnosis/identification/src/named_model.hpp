// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// The base with the candidates of the wanted rounds, at the current values. A candidate that
/// changes the term of another one follows it, and is left out with it.
template <class Wanted>
[[nodiscard]] Hypothesis with_rounds(const Hypothesis& base,
                                     const std::vector<SelectionRound>& rounds,
                                     const Wanted& wanted, const Hypothesis& current) {
  std::vector<const SelectionRound*> missing, waiting;
  for (const SelectionRound& round : rounds) {
    missing.push_back(&round);
    if (wanted(round)) waiting.push_back(&round);
  }
  const auto is_ready = [&](const SelectionRound* round) {
    return std::none_of(missing.begin(), missing.end(), [&](const SelectionRound* other) {
      return depends_on(round->chosen.candidate, other->chosen.candidate);
    });
  };
  Hypothesis rest = base;
  for (auto next = std::find_if(waiting.begin(), waiting.end(), is_ready); next != waiting.end();
       next = std::find_if(waiting.begin(), waiting.end(), is_ready)) {
    const Candidate& candidate = (*next)->chosen.candidate;
    rest = extended(rest, candidate, candidate.starts[0]);
    std::erase(missing, *next);
    waiting.erase(next);
  }
  take_values(current, rest);
  return rest;
}

/// Every candidate of a round, in no order.
[[nodiscard]] std::vector<ScoredCandidate> ranked_of(const SelectionRound& round);

/// Removes ties with candidates that another round has named.
void drop_named(std::vector<SelectionRound>& rounds);

/// Whether a round named another hysteresis rule, not an added effect.
[[nodiscard]] inline bool is_rule(const SelectionRound& round) {
  return round.chosen.candidate.is_rule;
}

/// Whether a round named an effect of exact form.
[[nodiscard]] inline bool is_exact(const SelectionRound& round) {
  return round.chosen.candidate.is_exact;
}

/// Beside it, a small effect is no error of its form: further effects are measured by what it
/// leaves.
[[nodiscard]] inline bool hides_nothing(const SelectionRound& round) {
  return is_rule(round) || is_exact(round);
}

/// Whether a round changes a term that another one has named.
[[nodiscard]] inline bool changes_named(const std::vector<SelectionRound>& rounds,
                                        const SelectionRound& round) {
  return std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& other) {
    return depends_on(round.chosen.candidate, other.chosen.candidate);
  });
}

}  // namespace rths::diagnosis
