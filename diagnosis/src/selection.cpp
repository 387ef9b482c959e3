// SPDX-License-Identifier: Apache-2.0
#include "selection.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace rths::diagnosis {
namespace {

constexpr int kMostTerms = 4;
constexpr int kLongFit = 12, kShortFit = 5, kHeat = 3;  // iterations
constexpr std::size_t kEntered = 10, kKept = 5, kMostKept = 10;
constexpr double kEnteredShare = 0.02;     // of the best screened gain
constexpr double kKeptShare = 0.35;        // of what the best fit of the heats won
constexpr double kTriedGain = 6;           // [nat]: below it no candidate is worth a fit
constexpr double kFar = 10;                // mean w²: so far off, the base's fit is a compromise
constexpr double kReversedShare = 0.5;     // of the best gain on the second fold
constexpr double kAcceptedGain = 18;       // [nat] over both folds, and
constexpr double kAcceptedDensity = 2e-3;  // [nat] per observation, and
constexpr double kAcceptedShare = 0.01;    // of the excess that the base had
constexpr double kTieShare = 0.01;         // of the best gain: nobody prefers one for that
constexpr double kMaterial = 2e-4;         // of the output's standard deviation: less is no physics
constexpr double kWhite = 1.02;            // mean w² at which nothing is left to find

std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(std::min(a.size(), b.size()));
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] = a[i] - b[i];
  return difference;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

Hypothesis fitted(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold,
                  int iterations) {
  const Supposition supposition{problem, hypothesis};
  Hypothesis result = supposition.hypothesis();
  result.values = supposition.fit(fold, iterations).parameters;
  return result;
}

std::vector<double> scores(const Problem& problem, const Hypothesis& hypothesis, const Fold& fold) {
  return Supposition{problem, hypothesis}.blocks(fold);
}

// One step of the forward selection.
class Round {
 public:
  Round(Problem& problem, const Folds& folds, const Hypothesis& current,
        const Eigen::VectorXd& stated, const std::vector<Candidate>& candidates, std::uint64_t seed)
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
    allow_for_noise(problem);
    reverse();
    rank();
  }

  [[nodiscard]] const Hypothesis& base() const { return base_; }
  [[nodiscard]] std::vector<Contender>& contenders() { return contenders_; }

 private:
  // A candidate after a short fit from its best start.
  struct Entrant {
    const Candidate* candidate;
    Hypothesis hypothesis;
    double least;  // sum of squares on the first fold
  };

  // Screening is linear; effects are not. A few steps of a fit tell who is worth the rest.
  void enter(const Hypothesis& from, const std::vector<Candidate>& candidates, double base,
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

  void warm_up(Hypothesis hypothesis, Entrant& entrant) const {
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

  static void keep_best(double base, std::vector<Entrant>& entrants) {
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

  void finish(Entrant& entrant) {
    Contender contender{*entrant.candidate, {}, 0, {}, 0, 0, 0};
    contender.fitted =
        fitted(problem_, std::move(entrant.hypothesis), folds_.first, kLongFit - kHeat);
    contender.differences = minus(base_scores_, scores(problem_, contender.fitted, folds_.second));
    contender.gain = sum(contender.differences);
    contenders_.push_back(std::move(contender));
  }

  void sort() {
    std::stable_sort(contenders_.begin(), contenders_.end(),
                     [](const Contender& a, const Contender& b) { return a.gain > b.gain; });
  }

  // What looks at one more channel has that channel's noise as well, and is compared with those
  // that have not in the largest noise that one of the better ones has.
  void allow_for_noise(Problem& problem) {
    constexpr double kGoodShare = 0.2, kMuchMore = 0.3;
    const double before = log_noise(problem);
    double most = kMuchMore;
    const Contender* noisiest = nullptr;
    for (const auto& contender : contenders_) {
      if (contender.gain < kGoodShare * contenders_[0].gain) break;
      problem.renew_noise(contender.fitted);
      const double more = log_noise(problem) - before;
      if (more > most) most = more, noisiest = &contender;
    }
    problem.renew_noise(noisiest != nullptr ? noisiest->fitted : base_);
    if (noisiest == nullptr) return;
    base_ = fitted(problem, base_, folds_.first, kShortFit);
    base_scores_ = scores(problem, base_, folds_.second);
    for (auto& contender : contenders_) {
      contender.fitted = fitted(problem, contender.fitted, folds_.first, kLongFit);
      contender.differences = minus(base_scores_, scores(problem, contender.fitted, folds_.second));
      contender.gain = sum(contender.differences);
    }
    sort();
  }
  static double log_noise(const Problem& problem) {
    double sum = 0;
    for (std::size_t i = 0; i < problem.records(); ++i) sum += problem.noise(i).log_size();
    return sum / static_cast<double>(problem.records());
  }

  // Fitted on the second fold, scored on the first: for those that did well.
  void reverse() {
    if (contenders_.empty()) return;
    const double best = contenders_[0].gain;
    while (contenders_.size() > 1 && contenders_.back().gain < kReversedShare * best) {
      beaten_.push_back(std::move(contenders_.back()));
      contenders_.pop_back();
    }
    const auto base_reversed =
        scores(problem_, fitted(problem_, base_, folds_.second, kShortFit), folds_.first);
    for (auto& contender : contenders_) {
      const auto back =
          minus(base_reversed,
                scores(problem_, fitted(problem_, contender.fitted, folds_.second, kShortFit),
                       folds_.first));
      contender.differences.insert(contender.differences.end(), back.begin(), back.end());
      contender.gain += sum(back);
    }
    sort();
  }

  // How often each is the best, were the records others.
  void rank() {
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

  const Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
  Hypothesis base_;
  std::vector<double> base_scores_;
  std::vector<Contender> contenders_, beaten_;
};

bool is_acceptable(const Contender& contender, double accepted, std::uint64_t seed) {
  if (contender.gain <= accepted) return false;
  // What shows at one instant only is often not among the resampled ones: then it has to be clear,
  // and to cost nothing anywhere else.
  const double low = quantile(resampled_sums(contender.differences, seed), 0.01);
  return low > 0 || (contender.gain > 20 * kAcceptedGain && low > -0.01 * contender.gain);
}

// Takes out those that wait for another that is acceptable as well.
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

// The cheapest of those that cannot be told from the best.
Step chosen(std::vector<Contender> contenders, std::uint64_t seed) {
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
  Step step;
  step.chosen = std::move(contenders[cheapest]);
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    if (i == cheapest) continue;
    // What is the chosen one and something that does not show is not another answer.
    const auto& contained = contenders[i].candidate.contains;
    const bool is_more = ties[i] && std::find(contained.begin(), contained.end(),
                                              step.chosen.candidate.name) != contained.end();
    if (is_more) step.chosen.confidence += contenders[i].confidence;
    (ties[i] && !is_more ? step.tied : step.others).push_back(std::move(contenders[i]));
  }
  return step;
}

// What the term changes of the prediction, over what the output varies by.
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

std::vector<Candidate> without(std::vector<Candidate> candidates, const std::vector<Step>& steps) {
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return std::any_of(steps.begin(), steps.end(), [&](const Step& step) {
      return step.chosen.candidate.name == candidate.name &&
             step.chosen.candidate.channel == candidate.channel;
    });
  });
  return candidates;
}

Hypothesis without_term(const Hypothesis& base, const std::vector<Step>& steps,
                        std::size_t left_out, const Hypothesis& current) {
  Hypothesis rest = base;
  for (std::size_t i = 0; i < steps.size(); ++i)
    if (i != left_out)
      rest = extended(rest, steps[i].chosen.candidate, steps[i].chosen.candidate.starts[0]);
  for (std::size_t i = 0; i < rest.free.size(); ++i)
    for (std::size_t k = 0; k < current.free.size(); ++k)
      if (rest.free[i].name == current.free[k].name)
        rest.values[static_cast<Eigen::Index>(i)] = current.values[static_cast<Eigen::Index>(k)];
  return rest;
}

// What was named in another step is no rival of this one.
void drop_named(std::vector<Step>& steps) {
  for (auto& step : steps) {
    const auto is_named = [&](const Contender& tied) {
      return std::any_of(steps.begin(), steps.end(), [&](const Step& other) {
        return other.chosen.candidate.name == tied.candidate.name &&
               other.chosen.candidate.channel == tied.candidate.channel;
      });
    };
    std::erase_if(step.tied, is_named);
  }
}

}  // namespace

double Selection::explained() const {
  const double excess = variance_base - 1;
  return excess > 0 ? std::clamp((excess - (variance_named - 1)) / excess, 0.0, 1.0) : 0;
}

bool Selection::has_remainder() const {
  const double rest = variance_named - 1;
  return rest > std::max(0.15, 0.005 * (variance_base - 1)) || (rest > 0.05 && explained() < 0.85);
}

std::vector<double> resampled_sums(const std::vector<double>& blocks, std::uint64_t seed) {
  constexpr int kResamples = 400;
  constexpr std::size_t kNeighbours = 3;
  std::vector<double> sums;
  if (blocks.size() < kNeighbours) return sums;
  std::mt19937_64 random{seed};
  for (int k = 0; k < kResamples; ++k) {
    double total = 0;
    std::size_t taken = 0;
    while (taken < blocks.size()) {
      const std::size_t first = random() % (blocks.size() - kNeighbours + 1);
      for (std::size_t i = 0; i < kNeighbours && taken < blocks.size(); ++i, ++taken)
        total += blocks[first + i];
    }
    sums.push_back(total);
  }
  return sums;
}

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const auto place = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(place),
                   values.end());
  return values[place];
}

Selection select(Problem& problem, const Folds& folds, std::uint64_t seed) {
  Selection selection;
  const Hypothesis stated = problem.relation().base();
  // The noise shows through the model as it fits, not as it was stated.
  Hypothesis current = fitted(problem, stated, folds.first, kShortFit);
  problem.renew_noise(current);
  selection.base = fitted(problem, current, folds.both, kLongFit);
  const double n = observations(problem, folds.both);
  {
    const Hypothesis first = fitted(problem, current, folds.first, kShortFit);
    selection.first_excess = Supposition{problem, first}.variance(folds.second) - 1;
    current = first;
  }
  const auto candidates = problem.relation().candidates();
  while (selection.steps.size() < kMostTerms) {
    Round round{problem, folds, current, stated.values, without(candidates, selection.steps), seed};
    auto& contenders = round.contenders();
    const double accepted =
        std::max({kAcceptedGain, kAcceptedDensity * n,
                  kAcceptedShare * 0.5 * n * std::max(0.0, selection.first_excess)});
    auto waiting = held_back(contenders, accepted, seed);
    if (contenders.empty() || !is_acceptable(contenders[0], accepted, seed) ||
        change_of(problem, round.base(), contenders[0].fitted, folds.second) < kMaterial) {
      selection.last = std::move(contenders);
      break;
    }
    selection.steps.push_back(chosen(std::move(contenders), seed));
    // What contains it as a special case is no rival of it.
    for (const auto& contender : waiting)
      selection.steps.back().chosen.confidence += contender.confidence;
    auto& others = selection.steps.back().others;
    others.insert(others.begin(), std::make_move_iterator(waiting.begin()),
                  std::make_move_iterator(waiting.end()));
    current = selection.steps.back().chosen.fitted;
    problem.renew_noise(current);
    if (Supposition{problem, current}.variance(folds.second) < kWhite) break;
  }
  // Backward: what the others have made superfluous.
  for (std::size_t i = 0; selection.steps.size() > 1 && i < selection.steps.size();) {
    const Hypothesis rest = fitted(
        problem, without_term(selection.base, selection.steps, i, current), folds.first, kLongFit);
    const auto cost =
        minus(scores(problem, rest, folds.second), scores(problem, current, folds.second));
    if (quantile(resampled_sums(cost, seed), 0.01) > 0 && sum(cost) > kAcceptedGain / 2) {
      ++i;
      continue;
    }
    selection.steps.erase(selection.steps.begin() + static_cast<std::ptrdiff_t>(i));
    current = rest;
    i = 0;
  }
  drop_named(selection.steps);
  selection.named = fitted(problem, current, folds.both, kLongFit);
  problem.renew_noise(selection.named);
  selection.named = fitted(problem, selection.named, folds.both, kShortFit);
  selection.base = fitted(problem, selection.base, folds.both, kShortFit);
  selection.variance_base = Supposition{problem, selection.base}.variance(folds.both);
  selection.variance_named = Supposition{problem, selection.named}.variance(folds.both);
  return selection;
}

}  // namespace rths::diagnosis
