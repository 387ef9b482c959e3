// SPDX-License-Identifier: Apache-2.0
#include "round.hpp"

#include <algorithm>
#include <cmath>

#include <rths/core/text.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/proof.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {
namespace {

double value_there(const Hypothesis& hypothesis, const std::string& parameter) {
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i)
    if (hypothesis.free[i].name == parameter) return hypothesis.values[static_cast<Index>(i)];
  return 0;
}

// Σ w² over a fold.
double energy_of(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold) {
  return TestedHypothesis{problem, hypothesis}.variance(fold) * observations(problem, fold);
}

// Whether fits from these two begin at the same place, by the sizes of significant changes.
bool is_near(const Hypothesis& one, const Hypothesis& other) {
  for (std::size_t i = 0; i < one.free.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    if (std::abs(one.values[at] - other.values[at]) > one.free[i].scale) return false;
  }
  return true;
}

// A candidate in the place of the holder: all parameters have the values of the whole model, and
// those of the candidate the values of the holder's parameters of the same name.
Hypothesis in_place(const Hypothesis& rest, const Candidate& candidate, VectorXd start,
                    const Hypothesis& whole, const Candidate& holder) {
  for (std::size_t i = 0; i < candidate.frees.size(); ++i)
    for (const auto& held : holder.frees)
      if (held.unit == candidate.frees[i].unit &&
          last_name(held.name) == last_name(candidate.frees[i].name))
        start[static_cast<Index>(i)] = value_there(whole, held.name);
  Hypothesis result = extended(rest, candidate, start);
  take_values(whole, result);
  return result;
}

// Of an effect on one axis, only what explains nearly as much as the effect on all axes, and is
// among the best, is fitted.
std::vector<Screened> screened_by(const TestedHypothesis& base, const Fold& fold,
                                  const std::vector<Candidate>& candidates) {
  auto screened = screen(base, fold, candidates);
  const double best = screened.empty() ? 0 : screened[0].gain;
  const auto all = screened;
  std::erase_if(screened, [&](const Screened& one) {
    if (one.candidate->axis.empty()) return false;
    const auto whole = std::find_if(all.begin(), all.end(), [&](const Screened& other) {
      return other.candidate->axis.empty() && is_same(*other.candidate, *one.candidate);
    });
    return one.gain < kShareOfBest * best ||
           (whole != all.end() && one.gain < kShareOfAllAxes * whole->gain);
  });
  return screened;
}

}  // namespace

Round::Round(Problem& problem, const Folds& folds, const Extended& extended,
             const std::vector<Candidate>& candidates, std::uint64_t seed, const Effort& effort)
    : problem_{problem}, folds_{folds}, seed_{seed}, effort_{effort} {
  base_ = fitted(problem, extended.model, folds.first, kLongFit);
  base_scores_ = scores(problem, base_, folds.second);
  const double base = energy_of(problem, base_, folds.first);
  std::vector<ShortFit> fits;
  try_best(base_, candidates, base, fits);
  Hypothesis as_stated = extended.model;
  as_stated.values.head(extended.stated.size()) = extended.stated;
  if (base > kFar * observations(problem, folds.first) && !is_near(base_, as_stated))
    try_best(as_stated, candidates, base, fits);
  compare(base, std::move(fits));
}

Round::Round(Problem& problem, const Folds& folds, const Defended& term,
             const std::vector<Candidate>& candidates, std::uint64_t seed)
    : problem_{problem}, folds_{folds}, seed_{seed} {
  base_ = fitted(problem, term.rest, folds.first, kLongFit);
  base_scores_ = scores(problem, base_, folds.second);
  const double base = energy_of(problem, base_, folds.first);
  std::vector<ShortFit> fits;
  try_rivals(term, candidates, base, fits);
  compare(base, std::move(fits));
}

void Round::compare(double base, std::vector<ShortFit> fits) {
  keep_best(base, fits);
  problem_.progress().begin_step("full fits", fits.size());
  for (auto& fit : fits) finish(fit);
  if (!ranked_.empty()) best_fit_ = ranked_[0];
  sort();
  allow_for_noise();
  reverse();
  rank();
  measure_rest();
}

// Screening is linear, effects are not. A few iterations show which candidates deserve a full fit.
void Round::try_best(const Hypothesis& from, const std::vector<Candidate>& candidates, double base,
                     std::vector<ShortFit>& fits) const {
  const auto screened = screened_by(TestedHypothesis{problem_, from}, folds_.first, candidates);
  problem_.progress().begin_step("short fits",
                                 std::min(screened.size(), effort_.tried) * effort_.starts);
  for (std::size_t i = 0; i < std::min(screened.size(), effort_.tried); ++i) {
    if (screened[i].gain < std::max(effort_.least, kTriedShare * screened[0].gain) ||
        problem_.progress().is_search_over())
      break;
    ShortFit fit{screened[i].candidate, {}, base};
    const std::size_t tries = std::min(screened[i].starts.size(), effort_.starts);
    for (std::size_t k = 0; k < tries; ++k)
      fit_shortly(extended(from, *fit.candidate, screened[i].starts[k]), fit);
    if (!fit.hypothesis.free.empty()) fits.push_back(std::move(fit));
  }
}

// As try_best, but all fits start at the values of the whole model. The holder is tried first, and
// its special cases, which may have failed from far away.
void Round::try_rivals(const Defended& term, const std::vector<Candidate>& candidates, double base,
                       std::vector<ShortFit>& fits) const {
  auto screened = screened_by(TestedHypothesis{problem_, base_}, folds_.first, candidates);
  const double best = screened.empty() ? 0 : screened[0].gain;
  const auto comes_first = [&](const Screened& one) {
    return is_same(*one.candidate, term.holder) ||
           contains(term.holder.contains, one.candidate->name);
  };
  const auto rivals = std::stable_partition(screened.begin(), screened.end(), comes_first);
  std::size_t tried = 0;
  problem_.progress().begin_step("short fits",
                                 std::min(screened.size(), effort_.tried) * effort_.starts);
  for (auto one = screened.begin(); one != screened.end(); ++one) {
    const bool is_weak = one->gain < std::max(effort_.least, kTriedShare * best);
    if (one >= rivals && (is_weak || ++tried > effort_.tried)) continue;
    ShortFit fit{one->candidate, {}, base};
    const bool holds = is_same(*one->candidate, term.holder);
    const std::size_t tries = holds ? 1 : std::min(one->starts.size(), effort_.starts);
    for (std::size_t k = 0; k < tries; ++k)
      fit_shortly(in_place(base_, *one->candidate, one->starts[k], term.whole, term.holder), fit);
    if (!fit.hypothesis.free.empty()) fits.push_back(std::move(fit));
  }
}

void Round::fit_shortly(Hypothesis hypothesis, ShortFit& best) const {
  const auto fit = fit_if_possible(problem_, hypothesis, folds_.first, effort_.short_fit);
  if (!fit || !(fit->sum_of_squares < best.least)) return;
  best.least = fit->sum_of_squares;
  hypothesis.values = fit->parameters;
  best.hypothesis = std::move(hypothesis);
}

void Round::keep_best(double base, std::vector<ShortFit>& fits) const {
  std::stable_sort(fits.begin(), fits.end(),
                   [](const ShortFit& a, const ShortFit& b) { return a.least < b.least; });
  const double most = fits.empty() ? 0 : base - fits[0].least;
  std::vector<ShortFit> kept;
  for (auto& fit : fits) {
    const bool is_there = std::any_of(kept.begin(), kept.end(), [&](const ShortFit& other) {
      return other.candidate == fit.candidate;
    });
    const bool is_good = base - fit.least > kKeptShare * most;
    if (kept.size() >= (is_good ? effort_.most_kept : effort_.kept)) break;
    if (!is_there) kept.push_back(std::move(fit));
  }
  fits = std::move(kept);
}

void Round::finish(ShortFit& fit) {
  ScoredCandidate scored{*fit.candidate, {}, 0, {}, 0, 0, 0};
  scored.fitted = fitted(problem_, fit.hypothesis, folds_.first, kLongFit - effort_.short_fit);
  score(scored);
  ranked_.push_back(std::move(scored));
}

void Round::score(ScoredCandidate& scored) const {
  scored.differences = minus(base_scores_, scores(problem_, scored.fitted, folds_.second));
  scored.gain = sum(scored.differences);
}

// Two terms may be the same law for a model, such as a stop behind a gap and stiffening beyond an
// onset on one axis. Their gains then differ by the rounding of their fits alone, and the order of
// their names decides.
void Round::sort() {
  std::stable_sort(
      ranked_.begin(), ranked_.end(),
      [](const ScoredCandidate& a, const ScoredCandidate& b) { return a.gain > b.gain; });
  if (ranked_.empty()) return;
  const double least = (1 - kSameGain) * ranked_[0].gain;
  const auto last = std::find_if(ranked_.begin() + 1, ranked_.end(),
                                 [&](const ScoredCandidate& one) { return !(one.gain > least); });
  const auto first = std::min_element(ranked_.begin(), last,
                                      [](const ScoredCandidate& a, const ScoredCandidate& b) {
                                        return a.candidate.name < b.candidate.name;
                                      });
  std::rotate(ranked_.begin(), first, first + 1);
}

// A candidate that uses one more channel also has the noise of that channel. All candidates are
// then compared in the largest noise that one of the better ones has.
void Round::allow_for_noise() {
  const auto before = problem_.log_noise(base_);
  if (!before) return;
  double most = kMuchMoreNoise;
  const ScoredCandidate* noisiest = nullptr;
  for (const auto& scored : ranked_) {
    if (scored.gain < kGoodShare * ranked_[0].gain) break;
    const auto noise = problem_.log_noise(scored.fitted);
    if (noise && *noise - *before > most) most = *noise - *before, noisiest = &scored;
  }
  if (noisiest == nullptr) return;
  problem_.renew_noise(noisiest->fitted);
  base_ = fitted(problem_, base_, folds_.first, kShortFit);
  base_scores_ = scores(problem_, base_, folds_.second);
  for (auto& scored : ranked_) {
    scored.fitted = fitted(problem_, scored.fitted, folds_.first, kLongFit);
    score(scored);
  }
  sort();
}

// Fits the better candidates on the second fold and scores them on the first. The second may lack
// the event that explains the first: so the one that fits the first best is tried too, and stays if
// it is the best of all.
void Round::reverse() {
  if (ranked_.empty()) return;
  const double least = kReversedShare * ranked_[0].gain;
  const auto fits_best = [&](const ScoredCandidate& scored) {
    return is_same(scored.candidate, best_fit_->candidate);
  };
  const auto is_worse = [&](const ScoredCandidate& scored) { return scored.gain < least; };
  const auto second = ranked_.begin() + 1;
  const bool is_event = std::any_of(second, ranked_.end(), [&](const ScoredCandidate& scored) {
    return is_worse(scored) && fits_best(scored);
  });
  ranked_.erase(std::remove_if(second, ranked_.end(),
                               [&](const ScoredCandidate& scored) {
                                 return is_worse(scored) && !fits_best(scored);
                               }),
                ranked_.end());
  const auto backwards = [&](const Hypothesis& hypothesis) {
    return scores(problem_, fitted(problem_, hypothesis, folds_.second, kShortFit), folds_.first);
  };
  problem_.progress().begin_step("fits with the records exchanged", ranked_.size() + 1);
  const auto base = backwards(base_);
  for (auto& scored : ranked_) {
    const auto back = minus(base, backwards(scored.fitted));
    scored.differences.insert(scored.differences.end(), back.begin(), back.end());
    scored.gain += sum(back);
  }
  sort();
  if (is_event && !fits_best(ranked_[0])) std::erase_if(ranked_, fits_best);
}

void Round::measure_rest() {
  if (ranked_.empty()) return;
  const TestedHypothesis best{problem_, ranked_[0].fitted};
  scatter_ = scatter_of(best, folds_.second);
  if (scatter_ > 1)
    rest_ = 0.5 * observations(problem_, folds_.both) * (best.variance(folds_.second) - 1);
}

// Confidence: how often each is the best in resampled records.
void Round::rank() {
  std::vector<std::vector<double>> sums;
  for (auto& scored : ranked_) {
    sums.push_back(resampled_sums(scored.differences, seed_));
    scored.low = maths::quantile(sums.back(), 0.05);
    scored.high = maths::quantile(sums.back(), 0.95);
  }
  for (std::size_t k = 0; !sums.empty() && k < sums[0].size(); ++k) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < sums.size(); ++i)
      if (sums[i][k] > sums[best][k]) best = i;
    ranked_[best].confidence += 1 / static_cast<double>(sums[0].size());
  }
}

}  // namespace rths::diagnosis
