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
constexpr double kAcceptedGain = 18;       // [nat] over both folds, and
constexpr double kAcceptedDensity = 2e-3;  // [nat] per observation, and
constexpr double kAcceptedShare = 0.01;    // of the excess that the base had
constexpr double kTieShare = 0.01;         // of the best gain: nobody prefers one for that
constexpr double kMaterial = 2e-4;         // of the output's standard deviation: less is no physics
constexpr double kWhite = 1.02;            // mean w² at which nothing is left to find

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

// Those of the candidates that are not named yet.
std::vector<Candidate> left_of(std::vector<Candidate> candidates, const std::vector<Step>& steps,
                               const Hypothesis& current) {
  std::erase_if(candidates, [&](const Candidate& candidate) {
    return !may_extend(current, candidate) ||
           std::any_of(steps.begin(), steps.end(), [&](const Step& step) {
             return step.chosen.candidate.name == candidate.name &&
                    step.chosen.candidate.channel == candidate.channel;
           });
  });
  return candidates;
}

// The base with some of the steps, its values as they are now.
template <class Wanted>
Hypothesis with_steps(const Hypothesis& base, const std::vector<Step>& steps, const Wanted& wanted,
                      const Hypothesis& current) {
  Hypothesis rest = base;
  for (const Step& step : steps)
    if (wanted(step)) rest = extended(rest, step.chosen.candidate, step.chosen.candidate.starts[0]);
  for (std::size_t i = 0; i < rest.free.size(); ++i)
    for (std::size_t k = 0; k < current.free.size(); ++k)
      if (rest.free[i].name == current.free[k].name)
        rest.values[static_cast<Eigen::Index>(i)] = current.values[static_cast<Eigen::Index>(k)];
  return rest;
}

bool is_rule(const Step& step) { return step.chosen.candidate.is_rule; }

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

bool Selection::has_only_rules() const { return std::all_of(steps.begin(), steps.end(), is_rule); }

bool Selection::has_remainder() const {
  const double rest = variance_named - 1;
  return rest > std::max(0.15, 0.005 * (variance_ruled - 1)) || (rest > 0.05 && explained() < 0.85);
}

Selection select(Problem& problem, const Folds& folds, std::uint64_t seed) {
  Selection selection;
  const Hypothesis stated = problem.relation().base();
  // The noise shows through the model as it fits, not as it was stated.
  Hypothesis current = fitted(problem, stated, folds.first, kShortFit);
  problem.renew_noise(current);
  selection.base = fitted(problem, current, folds.both, kLongFit);
  const double n = observations(problem, folds.both);
  current = fitted(problem, current, folds.first, kShortFit);
  // Of the base at its own noise, on rows that it was not fitted to.
  double excess = Supposition{problem, current}.variance(folds.second) - 1;
  const auto candidates = problem.relation().candidates();
  const auto effects = [&] {
    return std::count_if(selection.steps.begin(), selection.steps.end(), std::not_fn(is_rule));
  };
  while (effects() < kMostTerms) {
    Round round{
        problem, folds, current, stated.values, left_of(candidates, selection.steps, current),
        seed};
    auto& contenders = round.contenders();
    const double accepted = std::max(
        {kAcceptedGain, kAcceptedDensity * n, kAcceptedShare * 0.5 * n * std::max(0.0, excess)});
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
    const double variance = Supposition{problem, current}.variance(folds.second);
    // What else is missing is measured by what the right rule leaves.
    if (is_rule(selection.steps.back()))
      excess = variance - 1;
    else if (variance < kWhite)
      break;
  }
  // Backward: what the others have made superfluous.
  for (std::size_t i = 0; selection.steps.size() > 1 && i < selection.steps.size();) {
    const auto is_other = [&](const Step& step) { return &step != &selection.steps[i]; };
    const Hypothesis rest =
        fitted(problem, with_steps(selection.base, selection.steps, is_other, current), folds.first,
               kLongFit);
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
  std::stable_partition(selection.steps.begin(), selection.steps.end(), std::not_fn(is_rule));
  selection.named = fitted(problem, current, folds.both, kLongFit);
  problem.renew_noise(selection.named);
  selection.named = fitted(problem, selection.named, folds.both, kShortFit);
  selection.base = fitted(problem, selection.base, folds.both, kShortFit);
  selection.ruled = with_steps(selection.base, selection.steps, is_rule, selection.named);
  if (effects() < std::ssize(selection.steps))
    selection.ruled = fitted(problem, selection.ruled, folds.both, kLongFit);
  selection.variance_base = Supposition{problem, selection.base}.variance(folds.both);
  selection.variance_ruled = Supposition{problem, selection.ruled}.variance(folds.both);
  selection.variance_named = Supposition{problem, selection.named}.variance(folds.both);
  return selection;
}

}  // namespace rths::diagnosis
