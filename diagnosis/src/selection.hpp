// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "screening.hpp"

namespace rths::diagnosis {

/// The records as the selection uses them: what is fitted on one fold is scored on the other.
struct Folds {
  Fold first, second;
  Fold both;  ///< what final parameters are fitted to
};

/// A candidate that was fitted on one fold and scored on the other, both ways.
struct Contender {
  Candidate candidate;
  Hypothesis fitted;                ///< on the first fold
  double gain = 0;                  ///< over both folds [nat]
  std::vector<double> differences;  ///< of every block [nat]
  double low = 0, high = 0;         ///< 5 % and 95 % of resampled gains [nat]
  double confidence = 0;            ///< share of resampled records in which it is the best
};

/// A step of the selection: the term that was taken, and those that were not.
struct Step {
  Contender chosen;
  std::vector<Contender> tied;    ///< not significantly worse, or worse by little
  std::vector<Contender> others;  ///< the rest, best first
};

/// What a relation lacks.
struct Selection {
  std::vector<Step> steps;      ///< terms that were taken, in order, rules of hysteresis last
  std::vector<Contender> last;  ///< contenders of the step in which none was taken
  Hypothesis base;              ///< fitted to both folds
  Hypothesis ruled;             ///< the base with the rules alone
  Hypothesis named;             ///< the base with all terms
  double variance_base = 1;     ///< mean w² over both folds, with the noise at `named` [-]
  double variance_ruled = 1;
  double variance_named = 1;
  /// Whether nothing but the rule of hysteresis is named; so it is if nothing is.
  [[nodiscard]] bool has_only_rules() const;
  /// Part of the excess that the named terms explain [-].
  [[nodiscard]] double explained() const;
  /// Whether something systematic is left.
  [[nodiscard]] bool has_remainder() const;
};

/// Forward and backward selection with held-out scores. The problem's noise is renewed at the
/// result.
[[nodiscard]] Selection select(Problem& problem, const Folds& folds, std::uint64_t seed);

}  // namespace rths::diagnosis
