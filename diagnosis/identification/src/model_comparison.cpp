// SPDX-License-Identifier: Apache-2.0
#include "model_comparison.hpp"

#include <algorithm>
#include <cmath>

#include <rths/identification/constants.hpp>
#include <rths/identification/proof.hpp>
#include <rths/identification/scores.hpp>

#include "acceptance.hpp"

namespace rths::diagnosis {
namespace {

// Whether a relation compares two sensors of one motion.
bool compares_sensors(const Relation& relation) {
  const auto drivers = relation.drivers();
  return !drivers.empty() && drivers[0].starts_with("displacement.") &&
         relation.outputs()[0].first.starts_with("acceleration.");
}

}  // namespace

bool ModelComparison::predicts(const Hypothesis& model) const {
  const TestedHypothesis tested{problem_, model};
  for (std::size_t i = 0; i < problem_.records(); ++i)
    if (tested.prediction(i).size() == 0) return false;
  return true;
}

double ModelComparison::variance(const Hypothesis& model) const {
  return TestedHypothesis{problem_, model}.variance(folds_.second);
}

bool ModelComparison::is_noise(const Hypothesis& model) const {
  const TestedHypothesis tested{problem_, model};
  const double n = observations(problem_, folds_.second);
  if (!(tested.variance(folds_.second) < kNoiseVariance + 2 * std::sqrt(2 / n))) return false;
  const auto& shares = folds_.second.shares;
  return std::all_of(shares.begin(), shares.end(), [&](const Fold::Share& share) {
    return whiteness_of(tested, share.record).is_white;
  });
}

bool ModelComparison::is_material(const Hypothesis& without, const Hypothesis& with) const {
  const bool are_sensors = compares_sensors(problem_.relation());
  return change_of(problem_, without, with, folds_.second, are_sensors) >=
         (are_sensors ? kCalibrated : kMaterial);
}

ModelComparison::Scores ModelComparison::scores(const Hypothesis& model) const {
  const Hypothesis there = fitted(problem_, model, folds_.second, kShortFit);
  return {diagnosis::scores(problem_, model, folds_.second),
          diagnosis::scores(problem_, there, folds_.first)};
}

double ModelComparison::scatter(const Hypothesis& model) const {
  return scatter_of({problem_, model}, folds_.second);
}

bool ModelComparison::gains(const Scores& before, const Scores& after,
                            const Threshold& least) const {
  auto all = minus(before.second, after.second);
  const auto back = minus(before.first, after.first);
  all.insert(all.end(), back.begin(), back.end());
  return is_beneficial(all, least, seed_);
}

}  // namespace rths::diagnosis
