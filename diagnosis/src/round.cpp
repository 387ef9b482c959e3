// SPDX-License-Identifier: Apache-2.0
#include "round.hpp"

#include <algorithm>
#include <exception>

namespace rths::diagnosis {
namespace {

constexpr int kHeat = 3;  // iterations
constexpr std::size_t kEntered = 10, kKept = 5, kMostKept = 10;
constexpr double kEnteredShare = 0.02;  // of the best screened gain
constexpr double kKeptShare = 0.35;     // of what the best fit of the heats won
constexpr double kTriedGain = 6;        // [nat]: below it no candidate is worth a fit
constexpr double kFar = 10;             // mean w²: so far off, the base's fit is a compromise
constexpr double kReversedShare = 0.5;  // of the best gain on the second fold

}  // namespace

Round::Round(Problem& problem, const Folds& folds, const Hypothesis& current,
             const Eigen::VectorXd& stated, const std::vector<Candidate>& candidates,
             std::uint64_t seed)
    : problem_{problem}, folds_{folds}, seed_{seed} {
  base_ = fitted(problem, current, folds.first, kLongFit);
  base_scores_ = scores(problem, base_, folds.second);
  const double base = 2 * sum(scores(problem, base_, folds.first));
  std::vector<Entrant> entrants;
  enter(base_, candidates, base, entrants);
  if (base > kFar * observations(problem, folds.first)) {
    Hypothesis as_stated = current;
    as_stated.values.head(stated.size()) = stated;
    enter(as_stated, candidates, base, entrants);
  }
  keep_best(base, entrants);
  for (auto& entrant : entrants) finish(entrant);
  sort();
  allow_for_noise();
  reverse();
  rank();
}

// Screening is linear; effects are not. A few steps of a fit tell who is worth the rest.
void Round::enter(const Hypothesis& from, const std::vector<Candidate>& candidates, double base,
                  std::vector<Entrant>& entrants) const {
  const auto screened = screen(Supposition{problem_, from}, folds_.first, candidates);
  for (std::size_t i = 0; i < std::min(screened.size(), kEntered); ++i) {
    if (screened[i].gain < std::max(kTriedGain, kEnteredShare * screened[0].gain)) break;
    Entrant entrant{screened[i].candidate, {}, base};
    const std::size_t tries = std::min<std::size_t>(screened[i].starts.size(), 2);
    for (std::size_t k = 0; k < tries; ++k)
      warm_up(extended(from, *entrant.candidate, screened[i].starts[k]), entrant);
    if (!entrant.hypothesis.free.empty()) entrants.push_back(std::move(entrant));
  }
}

void Round::warm_up(Hypothesis hypothesis, Entrant& entrant) const {
  try {
    const Fit fit = Supposition{problem_, hypothesis}.fit(folds_.first, kHeat);
    if (!(fit.sum_of_squares < entrant.least)) return;
    entrant.least = fit.sum_of_squares;
    hypothesis.values = fit.parameters;
    entrant.hypothesis = std::move(hypothesis);
  } catch (const std::exception&) {
    // No prediction from this start.
  }
}

void Round::keep_best(double base, std::vector<Entrant>& entrants) {
  std::stable_sort(entrants.begin(), entrants.end(),
                   [](const Entrant& a, const Entrant& b) { return a.least < b.least; });
  const double most = entrants.empty() ? 0 : base - entrants[0].least;
  std::vector<Entrant> kept;
  for (auto& entrant : entrants) {
    const bool is_there = std::any_of(kept.begin(), kept.end(), [&](const Entrant& other) {
      return other.candidate == entrant.candidate;
    });
    const bool is_good = base - entrant.least > kKeptShare * most;
    if (kept.size() >= (is_good ? kMostKept : kKept)) break;
    if (!is_there) kept.push_back(std::move(entrant));
  }
  entrants = std::move(kept);
}

void Round::finish(Entrant& entrant) {
  Contender contender{*entrant.candidate, {}, 0, {}, 0, 0, 0};
  contender.fitted = fitted(problem_, entrant.hypothesis, folds_.first, kLongFit - kHeat);
  score(contender);
  contenders_.push_back(std::move(contender));
}

void Round::score(Contender& contender) const {
  contender.differences = minus(base_scores_, scores(problem_, contender.fitted, folds_.second));
  contender.gain = sum(contender.differences);
}

void Round::sort() {
  std::stable_sort(contenders_.begin(), contenders_.end(),
                   [](const Contender& a, const Contender& b) { return a.gain > b.gain; });
}

// What looks at one more channel has that channel's noise as well, and is compared with those
// that have not in the largest noise that one of the better ones has.
void Round::allow_for_noise() {
  constexpr double kGoodShare = 0.2, kMuchMore = 0.3;
  const double before = problem_.log_noise(base_);
  double most = kMuchMore;
  const Contender* noisiest = nullptr;
  for (const auto& contender : contenders_) {
    if (contender.gain < kGoodShare * contenders_[0].gain) break;
    const double more = problem_.log_noise(contender.fitted) - before;
    if (more > most) most = more, noisiest = &contender;
  }
  if (noisiest == nullptr) return;
  problem_.renew_noise(noisiest->fitted);
  base_ = fitted(problem_, base_, folds_.first, kShortFit);
  base_scores_ = scores(problem_, base_, folds_.second);
  for (auto& contender : contenders_) {
    contender.fitted = fitted(problem_, contender.fitted, folds_.first, kLongFit);
    score(contender);
  }
  sort();
}

// Fitted on the second fold, scored on the first: for those that did well.
void Round::reverse() {
  if (contenders_.empty()) return;
  const double best = contenders_[0].gain;
  while (contenders_.size() > 1 && contenders_.back().gain < kReversedShare * best)
    contenders_.pop_back();
  const auto backwards = [&](const Hypothesis& hypothesis) {
    return scores(problem_, fitted(problem_, hypothesis, folds_.second, kShortFit), folds_.first);
  };
  const auto base = backwards(base_);
  for (auto& contender : contenders_) {
    const auto back = minus(base, backwards(contender.fitted));
    contender.differences.insert(contender.differences.end(), back.begin(), back.end());
    contender.gain += sum(back);
  }
  sort();
}

// How often each is the best, were the records others.
void Round::rank() {
  std::vector<std::vector<double>> sums;
  for (auto& contender : contenders_) {
    sums.push_back(resampled_sums(contender.differences, seed_));
    contender.low = quantile(sums.back(), 0.05);
    contender.high = quantile(sums.back(), 0.95);
  }
  for (std::size_t k = 0; !sums.empty() && k < sums[0].size(); ++k) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < sums.size(); ++i)
      if (sums[i][k] > sums[best][k]) best = i;
    contenders_[best].confidence += 1 / static_cast<double>(sums[0].size());
  }
}

}  // namespace rths::diagnosis
