// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <rths/identification/selection.hpp>

#include "acceptance.hpp"

namespace rths::diagnosis {

/// Compares models that were fitted on the first fold, on rows that they were not fitted to.
class ModelComparison {
 public:
  ModelComparison(const Problem& problem, const Folds& folds, std::uint64_t seed)
      : problem_{problem}, folds_{folds}, seed_{seed} {}

  /// Whether a model predicts all records; one that was fitted to a fold may diverge on another.
  [[nodiscard]] bool predicts(const Hypothesis& model) const;
  /// Mean w² on the second fold [-].
  [[nodiscard]] double variance(const Hypothesis& model) const;
  /// Whether nothing is left to explain. If the sensors' noise is less than stated, an effect hides
  /// in its size, but not in its colour.
  [[nodiscard]] bool is_noise(const Hypothesis& model) const;
  /// Whether a term changes the prediction by so much that it counts. Two sensors of one motion are
  /// read at unknown instants, and calibrated to half a percent; a lag of 1.5 ms takes as much.
  [[nodiscard]] bool is_material(const Hypothesis& without, const Hypothesis& with) const;

  /// Of a model, and of it after a fit on the other fold.
  struct Scores {
    std::vector<double> second, first;  ///< on this fold, by block [nat]
  };
  [[nodiscard]] Scores scores(const Hypothesis& model) const;
  /// Whether a model gains more than a threshold over another one, see is_beneficial.
  [[nodiscard]] bool gains(const Scores& before, const Scores& after, const Threshold& least) const;
  /// See scatter_of, on the second fold [-].
  [[nodiscard]] double scatter(const Hypothesis& model) const;

 private:
  const Problem& problem_;
  const Folds& folds_;
  std::uint64_t seed_;
};

}  // namespace rths::diagnosis
