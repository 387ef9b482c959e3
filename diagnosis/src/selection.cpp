// SPDX-License-Identifier: Apache-2.0
#include "selection.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "round.hpp"
#include "scores.hpp"

namespace rths::diagnosis {
namespace {

constexpr std::ptrdiff_t kMostTerms = 4;   // besides rules
constexpr double kAcceptedGain = 18;       // smallest gain [nat] over both folds,
constexpr double kAcceptedDensity = 2e-3;  // [nat] per observation,
constexpr double kAcceptedShare = 0.01;    // and as a fraction of the excess of the base
constexpr double kTieShare = 0.01;         // of the best gain: smaller differences are ties
constexpr double kMaterial = 2e-4;         // of the output's standard deviation: smallest change
constexpr double kWhite = 1.02;            // mean w² of a residual that is noise

bool is_acceptable(const Contender& contender, double accepted, std::uint64_t seed) {
  if (contender.gain <= accepted) return false;
  // An effect at one instant is absent from many resampled records. It is accepted if its gain is
  // large and it costs nothing elsewhere.
  const double low = quantile(resampled_sums(contender.differences, seed), 0.01);
  return low > 0 || (contender.gain > 20 * kAcceptedGain && low > -0.01 * contender.gain);
}

// Removes and returns candidates that must wait for another acceptable one, see Candidate::after.
std::vector<Contender> held_back(std::vector<Contender>& contenders, double accepted,
                                 std::uint64_t seed) {
  const auto waits = [&](const Contender& contender) {
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

// Chooses the cheapest of the candidates that are not significantly worse than the best.
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
  return round;
}

// Change of the prediction due to a term, divided by the standard deviation of the output.
double change_of(const Problem& problem, const Hypothesis& before, const Hypothesis& after,
                 const Fold& fold) {
  const Supposition a{problem, before}, b{problem, after};
  double change = 0, size = 0;
  for (const auto& share : fold.shares) {
    const Eigen::MatrixXd with = b.prediction(share.record), bare = a.prediction(share.record);
    if (with.size() == 0 || bare.size() == 0) continue;
    Eigen::MatrixXd difference = with - bare;
    Eigen::MatrixXd measured = problem.drive(share.record).measured;
    if (problem.relation().has_free_offsets())
      difference.rowwise() -= difference.colwise().mean().eval();
    measured.rowwise() -= measured.colwise().mean().eval();
    change += difference.squaredNorm();
    size += measured.squaredNorm();
  }
  return std::sqrt(change / std::max(size, 1e-300));
}

// The candidates that are not named yet.
std::vector<Candidate> left_of(std::vector<Candidate> candidates,
                               const std::vector<SelectionRound>& rounds,
                               const Hypothesis& current) {
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return !may_extend(current, candidate) ||
           std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& round) {
             return round.chosen.candidate.name == candidate.name &&
                    round.chosen.candidate.channel == candidate.channel;
           });
  });
  return candidates;
}

// The base with the candidates of some rounds, with the current values.
template <class Wanted>
Hypothesis with_rounds(const Hypothesis& base, const std::vector<SelectionRound>& rounds,
                       const Wanted& wanted, const Hypothesis& current) {
  Hypothesis rest = base;
  for (const SelectionRound& round : rounds)
    if (wanted(round))
      rest = extended(rest, round.chosen.candidate, round.chosen.candidate.starts[0]);
  for (std::size_t i = 0; i < rest.free.size(); ++i)
    for (std::size_t k = 0; k < current.free.size(); ++k)
      if (rest.free[i].name == current.free[k].name)
        rest.values[static_cast<Eigen::Index>(i)] = current.values[static_cast<Eigen::Index>(k)];
  return rest;
}

bool is_rule(const SelectionRound& round) { return round.chosen.candidate.is_rule; }

// Removes ties with candidates that another round has named.
void drop_named(std::vector<SelectionRound>& rounds) {
  for (auto& round : rounds) {
    const auto is_named = [&](const Contender& tied) {
      return std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& other) {
        return other.chosen.candidate.name == tied.candidate.name &&
               other.chosen.candidate.channel == tied.candidate.channel;
      });
    };
    std::erase_if(round.tied, is_named);
  }
}

class Selector {
 public:
  Selector(Problem& problem, const Folds& folds, std::uint64_t seed)
      : problem_{problem}, folds_{folds}, seed_{seed}, stated_{problem.relation().base()} {}

  Selection select() {
    fit_base();
    const auto candidates = problem_.relation().candidates();
    bool goes_on = true;
    while (goes_on && effects() < kMostTerms) goes_on = add_term(candidates);
    drop_redundant();
    drop_named(selection_.rounds);
    std::stable_partition(selection_.rounds.begin(), selection_.rounds.end(), std::not_fn(is_rule));
    fit_final();
    return std::move(selection_);
  }

 private:
  // Number of accepted candidates that are not rules.
  [[nodiscard]] std::ptrdiff_t effects() const {
    return std::count_if(selection_.rounds.begin(), selection_.rounds.end(), std::not_fn(is_rule));
  }

  void fit_base() {
    // The noise of the residual depends on the fitted model, not on the stated one.
    current_ = fitted(problem_, stated_, folds_.first, kShortFit);
    problem_.renew_noise(current_);
    selection_.base = fitted(problem_, current_, folds_.both, kLongFit);
    current_ = fitted(problem_, current_, folds_.first, kShortFit);
    // Excess of the base at its own noise, on rows that it was not fitted to.
    excess_ = Supposition{problem_, current_}.variance(folds_.second) - 1;
  }

  // Runs one round. @returns whether another may follow
  bool add_term(const std::vector<Candidate>& candidates) {
    Round round{problem_,
                folds_,
                current_,
                stated_.values,
                left_of(candidates, selection_.rounds, current_),
                seed_};
    auto& contenders = round.contenders();
    const double n = observations(problem_, folds_.both);
    const double accepted = std::max(
        {kAcceptedGain, kAcceptedDensity * n, kAcceptedShare * 0.5 * n * std::max(0.0, excess_)});
    auto waiting = held_back(contenders, accepted, seed_);
    if (contenders.empty() || !is_acceptable(contenders[0], accepted, seed_) ||
        change_of(problem_, round.base(), contenders[0].fitted, folds_.second) < kMaterial) {
      selection_.last = std::move(contenders);
      return false;
    }
    selection_.rounds.push_back(chosen(std::move(contenders), seed_));
    SelectionRound& added = selection_.rounds.back();
    // Waiting candidates contain the chosen one as a special case, so they support it.
    for (const auto& contender : waiting) added.chosen.confidence += contender.confidence;
    added.others.insert(added.others.begin(), std::make_move_iterator(waiting.begin()),
                        std::make_move_iterator(waiting.end()));
    current_ = added.chosen.fitted;
    problem_.renew_noise(current_);
    const double variance = Supposition{problem_, current_}.variance(folds_.second);
    if (!is_rule(added)) return !(variance < kWhite);
    // Further terms are measured by the excess that the right rule leaves.
    excess_ = variance - 1;
    return true;
  }

  // Backward selection: removes candidates that later ones have made redundant.
  void drop_redundant() {
    auto& rounds = selection_.rounds;
    for (std::size_t i = 0; rounds.size() > 1 && i < rounds.size();) {
      const auto is_other = [&](const SelectionRound& round) { return &round != &rounds[i]; };
      const Hypothesis rest =
          fitted(problem_, with_rounds(selection_.base, rounds, is_other, current_), folds_.first,
                 kLongFit);
      const auto cost =
          minus(scores(problem_, rest, folds_.second), scores(problem_, current_, folds_.second));
      if (quantile(resampled_sums(cost, seed_), 0.01) > 0 && sum(cost) > kAcceptedGain / 2) {
        ++i;
        continue;
      }
      rounds.erase(rounds.begin() + static_cast<std::ptrdiff_t>(i));
      current_ = rest;
      i = 0;
    }
  }

  void fit_final() {
    selection_.named = fitted(problem_, current_, folds_.both, kLongFit);
    problem_.renew_noise(selection_.named);
    selection_.named = fitted(problem_, selection_.named, folds_.both, kShortFit);
    selection_.base = fitted(problem_, selection_.base, folds_.both, kShortFit);
    selection_.ruled = with_rounds(selection_.base, selection_.rounds, is_rule, selection_.named);
    if (effects() < std::ssize(selection_.rounds))
      selection_.ruled = fitted(problem_, selection_.ruled, folds_.both, kLongFit);
    selection_.variance_base = Supposition{problem_, selection_.base}.variance(folds_.both);
    selection_.variance_ruled = Supposition{problem_, selection_.ruled}.variance(folds_.both);
    selection_.variance_named = Supposition{problem_, selection_.named}.variance(folds_.both);
  }

  Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
  Hypothesis stated_, current_;
  double excess_ = 0;  // mean w² − 1, before the terms that are still to be found
  Selection selection_;
};

}  // namespace

double Selection::explained() const {
  const double excess = variance_base - 1;
  return excess > 0 ? std::clamp((excess - (variance_named - 1)) / excess, 0.0, 1.0) : 0;
}

bool Selection::has_only_rules() const {
  return std::all_of(rounds.begin(), rounds.end(), is_rule);
}

bool Selection::has_remainder() const {
  const double rest = variance_named - 1;
  return rest > std::max(0.15, 0.005 * (variance_ruled - 1)) || (rest > 0.05 && explained() < 0.85);
}

Selection select(Problem& problem, const Folds& folds, std::uint64_t seed) {
  return Selector{problem, folds, seed}.select();
}

}  // namespace rths::diagnosis
