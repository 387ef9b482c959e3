// SPDX-License-Identifier: Apache-2.0
#include "named_model.hpp"

#include <algorithm>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

namespace rths::diagnosis {

double Selection::explained() const {
  const double excess = variance_base - 1;
  return excess > 0 ? std::clamp((excess - (variance_named - 1)) / excess, 0.0, 1.0) : 0;
}

bool Selection::has_only_rules() const {
  return std::all_of(rounds.begin(), rounds.end(), is_rule);
}

std::vector<ScoredCandidate> ranked_of(const SelectionRound& round) {
  std::vector<ScoredCandidate> all{round.chosen};
  all.insert(all.end(), round.tied.begin(), round.tied.end());
  all.insert(all.end(), round.others.begin(), round.others.end());
  return all;
}

void drop_named(std::vector<SelectionRound>& rounds) {
  for (auto& round : rounds) {
    const auto is_named = [&](const ScoredCandidate& tied) {
      return std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& other) {
        return is_same(other.chosen.candidate, tied.candidate);
      });
    };
    std::erase_if(round.tied, is_named);
  }
}

bool is_needed(const Selection& selection, std::size_t index) {
  const Candidate& candidate = selection.rounds[index].chosen.candidate;
  return std::any_of(
      selection.rounds.begin(), selection.rounds.end(),
      [&](const SelectionRound& round) { return depends_on(round.chosen.candidate, candidate); });
}

Hypothesis without(const Problem& problem, const Folds& folds, const Selection& selection,
                   std::size_t index) {
  const auto& rounds = selection.rounds;
  const auto is_other = [&](const SelectionRound& round) { return &round != &rounds[index]; };
  return fitted(problem, with_rounds(selection.base, rounds, is_other, selection.named), folds.both,
                kLongFit);
}

void finish(Problem& problem, const Folds& folds, Selection& selection) {
  problem.renew_noise(selection.named);
  selection.named = fitted(problem, selection.named, folds.both, kShortFit);
  selection.base = fitted(problem, selection.base, folds.both, kShortFit);
  const auto& rounds = selection.rounds;
  const auto is_rule_of_base = [&](const SelectionRound& round) {
    return is_rule(round) && !changes_named(rounds, round);
  };
  selection.ruled = with_rounds(selection.base, rounds, is_rule_of_base, selection.named);
  if (std::any_of(rounds.begin(), rounds.end(), is_rule_of_base))
    selection.ruled = fitted(problem, selection.ruled, folds.both, kLongFit);
  selection.variance_base = TestedHypothesis{problem, selection.base}.variance(folds.both);
  selection.variance_ruled = TestedHypothesis{problem, selection.ruled}.variance(folds.both);
  selection.variance_named = TestedHypothesis{problem, selection.named}.variance(folds.both);
}

}  // namespace rths::diagnosis
