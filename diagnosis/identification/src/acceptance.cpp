// SPDX-License-Identifier: Apache-2.0
#include "acceptance.hpp"

#include <algorithm>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {

bool is_beneficial(const std::vector<double>& differences, const Threshold& least,
                   std::uint64_t seed) {
  const double gain = sum(differences);
  if (gain <= least.gain) return false;
  // An effect at one instant is absent from many resampled records. It is accepted if its gain is
  // large and it costs next to nothing elsewhere, or a little that scatter explains.
  const double low = maths::quantile(resampled_sums(differences, seed), 0.01);
  const double cost = std::max(kCostOfAnEvent * gain, std::min(kScatteredCost * gain, least.gain));
  return low > 0 || (gain > least.event && low > -cost);
}

bool is_acceptable(const ScoredCandidate& scored, const Threshold& accepted, std::uint64_t seed) {
  return is_beneficial(scored.differences, accepted, seed);
}

std::vector<ScoredCandidate> held_back(std::vector<ScoredCandidate>& ranked,
                                       const Candidate* holder, const Threshold& accepted,
                                       std::uint64_t seed) {
  // The best that waits for no other: a simpler candidate that gains less would not be named.
  double most = 0;
  for (const auto& scored : ranked)
    if (scored.candidate.after.empty() || (holder != nullptr && is_same(scored.candidate, *holder)))
      most = std::max(most, scored.gain);
  const auto waits = [&](const ScoredCandidate& scored) {
    if (holder != nullptr && is_same(scored.candidate, *holder)) return false;
    const auto& after = scored.candidate.after;
    return std::any_of(ranked.begin(), ranked.end(), [&](const ScoredCandidate& other) {
      return std::find(after.begin(), after.end(), other.candidate.name) != after.end() &&
             other.gain >= (1 - kTieShare) * most && is_acceptable(other, accepted, seed);
    });
  };
  std::vector<bool> is_waiting;
  for (const auto& scored : ranked) is_waiting.push_back(waits(scored));
  std::vector<ScoredCandidate> free, waiting;
  for (std::size_t i = 0; i < ranked.size(); ++i)
    (is_waiting[i] ? waiting : free).push_back(std::move(ranked[i]));
  ranked = std::move(free);
  return waiting;
}

namespace {

// One effect may be a candidate on all axes and on each of them. The better ones stand for the
// others.
void join_axes(SelectionRound& round) {
  const auto join = [](ScoredCandidate& winner, std::vector<ScoredCandidate>& list,
                       std::size_t from) {
    for (std::size_t i = from; i < list.size();) {
      if (!is_same(list[i].candidate, winner.candidate)) {
        ++i;
        continue;
      }
      winner.confidence += list[i].confidence;
      list.erase(list.begin() + static_cast<std::ptrdiff_t>(i));
    }
  };
  join(round.chosen, round.tied, 0);
  join(round.chosen, round.others, 0);
  for (std::size_t i = 0; i < round.tied.size(); ++i) {
    join(round.tied[i], round.tied, i + 1);
    join(round.tied[i], round.others, 0);
  }
  for (std::size_t i = 0; i < round.others.size(); ++i) join(round.others[i], round.others, i + 1);
}

}  // namespace

SelectionRound chosen(std::vector<ScoredCandidate> ranked, double rest, std::uint64_t seed) {
  const ScoredCandidate& best = ranked[0];
  std::vector<bool> ties(ranked.size(), true);
  std::size_t cheapest = 0;
  for (std::size_t i = 1; i < ranked.size(); ++i) {
    const auto lead = minus(best.differences, ranked[i].differences);
    const bool is_significant = maths::quantile(resampled_sums(lead, seed), 0.05) > 0;
    const double behind = best.gain - ranked[i].gain;
    const bool is_as_good = !is_significant || behind < kTieShare * best.gain;
    ties[i] = is_as_good || behind < kTieOfRest * rest;
    if (is_as_good && ranked[i].candidate.price < ranked[cheapest].candidate.price) cheapest = i;
  }
  SelectionRound round;
  round.chosen = std::move(ranked[cheapest]);
  for (std::size_t i = 0; i < ranked.size(); ++i) {
    if (i == cheapest) continue;
    // A candidate that contains the chosen one adds an effect that does not show: no alternative.
    const auto& contained = ranked[i].candidate.contains;
    const bool is_more = ties[i] && std::find(contained.begin(), contained.end(),
                                              round.chosen.candidate.name) != contained.end();
    if (is_more) round.chosen.confidence += ranked[i].confidence;
    (ties[i] && !is_more ? round.tied : round.others).push_back(std::move(ranked[i]));
  }
  join_axes(round);
  return round;
}

}  // namespace rths::diagnosis
