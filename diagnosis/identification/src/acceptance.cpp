// SPDX-License-Identifier: Apache-2.0
#include "acceptance.hpp"

#include <algorithm>

#include <rths/identification/constants.hpp>
#include <rths/identification/scores.hpp>

namespace rths::diagnosis {

bool is_beneficial(const std::vector<double>& differences, double least, std::uint64_t seed) {
  const double gain = sum(differences);
  if (gain <= least) return false;
  // An effect at one instant is absent from many resampled records. It is accepted if its gain is
  // large and it costs nothing elsewhere.
  const double low = quantile(resampled_sums(differences, seed), 0.01);
  return low > 0 || (gain > kLeastGainOfAnEvent && low > -0.01 * gain);
}

bool is_acceptable(const Contender& contender, double accepted, std::uint64_t seed) {
  return is_beneficial(contender.differences, accepted, seed);
}

std::vector<Contender> held_back(std::vector<Contender>& contenders, const Candidate* holder,
                                 double accepted, std::uint64_t seed) {
  const auto waits = [&](const Contender& contender) {
    if (holder != nullptr && is_same(contender.candidate, *holder)) return false;
    const auto& after = contender.candidate.after;
    return std::any_of(contenders.begin(), contenders.end(), [&](const Contender& other) {
      return std::find(after.begin(), after.end(), other.candidate.name) != after.end() &&
             is_acceptable(other, accepted, seed);
    });
  };
  std::vector<bool> is_waiting;
  for (const auto& contender : contenders) is_waiting.push_back(waits(contender));
  std::vector<Contender> free, waiting;
  for (std::size_t i = 0; i < contenders.size(); ++i)
    (is_waiting[i] ? waiting : free).push_back(std::move(contenders[i]));
  contenders = std::move(free);
  return waiting;
}

namespace {

// One effect may contend on all axes and on each of them. The better ones stand for the others.
void join_axes(SelectionRound& round) {
  const auto join = [](Contender& winner, std::vector<Contender>& list, std::size_t from) {
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

SelectionRound chosen(std::vector<Contender> contenders, std::uint64_t seed) {
  const Contender& best = contenders[0];
  std::vector<bool> ties(contenders.size(), true);
  std::size_t cheapest = 0;
  for (std::size_t i = 1; i < contenders.size(); ++i) {
    const auto lead = minus(best.differences, contenders[i].differences);
    const bool is_significant = quantile(resampled_sums(lead, seed), 0.05) > 0;
    ties[i] = !is_significant || best.gain - contenders[i].gain < kTieShare * best.gain;
    if (ties[i] && contenders[i].candidate.price < contenders[cheapest].candidate.price)
      cheapest = i;
  }
  SelectionRound round;
  round.chosen = std::move(contenders[cheapest]);
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    if (i == cheapest) continue;
    // A candidate that contains the chosen one adds an effect that does not show: no alternative.
    const auto& contained = contenders[i].candidate.contains;
    const bool is_more = ties[i] && std::find(contained.begin(), contained.end(),
                                              round.chosen.candidate.name) != contained.end();
    if (is_more) round.chosen.confidence += contenders[i].confidence;
    (ties[i] && !is_more ? round.tied : round.others).push_back(std::move(contenders[i]));
  }
  join_axes(round);
  return round;
}

}  // namespace rths::diagnosis
