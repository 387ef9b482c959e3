// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include <rths/identification/screening.hpp>

namespace rths::diagnosis {

/// Rows for cross-validation: a fit on one fold is scored on the other.
struct Folds {
  Fold first, second;
  Fold both;  ///< for the fit of the final parameters
};

/// A candidate that was fitted on one fold and scored on the other, both ways.
struct ScoredCandidate {
  Candidate candidate;
  Hypothesis fitted;                ///< on the first fold
  double gain = 0;                  ///< over both folds [nat]
  std::vector<double> differences;  ///< of every block [nat]
  double low = 0, high = 0;         ///< 5 % and 95 % of resampled gains [nat]
  double confidence = 0;            ///< share of resampled records in which it is the best
};

/// An accepted candidate, and the others: as extensions of the model that has all other accepted
/// candidates.
struct SelectionRound {
  ScoredCandidate chosen;
  std::vector<ScoredCandidate>
      tied;  ///< not significantly worse, or worse by less than 1 % of the gain
  std::vector<ScoredCandidate> others;  ///< the rest, best first
};

/// The terms that a relation lacks.
struct Selection {
  std::vector<SelectionRound> rounds;  ///< accepted candidates, in order, hysteresis rules last
  std::vector<ScoredCandidate> first;  ///< of the round in which the first was accepted
  std::vector<ScoredCandidate> last;   ///< of the round in which none was accepted
  bool is_complete = true;             ///< not ended by the bound of its work
  Hypothesis base;                     ///< fitted to both folds
  Hypothesis ruled;                    ///< the base with the accepted hysteresis rules only
  Hypothesis named;                    ///< the base with all accepted candidates
  double variance_base = 1;            ///< mean w² over both folds, with the noise at `named` [-]
  double variance_ruled = 1;
  double variance_named = 1;
  /// Returns true if only hysteresis rules are named, or nothing.
  [[nodiscard]] bool has_only_rules() const;
  /// Fraction of the excess that the named terms explain [-].
  [[nodiscard]] double explained() const;
};

/// Forward and backward selection with held-out scores, then a comparison of each named term with
/// its rivals in the final model. Renews the problem's noise at the result.
[[nodiscard]] Selection select(Problem& problem, const Folds& folds, std::uint64_t seed);

/// Compares each named term again with its rivals, after others were withdrawn, and renews its
/// ties. No term is replaced.
void renew_ties(Problem& problem, const Folds& folds, std::uint64_t seed,
                const std::vector<Candidate>& withdrawn, Selection& selection);

/// Returns true if another accepted candidate changes a term of the one at a place.
[[nodiscard]] bool is_needed(const Selection& selection, std::size_t place);
/// The named model without one accepted candidate, fitted to both folds.
[[nodiscard]] Hypothesis without(const Problem& problem, const Folds& folds,
                                 const Selection& selection, std::size_t place);
/// Fits the models of a selection to both folds, in the noise of the named one.
void finish(Problem& problem, const Folds& folds, Selection& selection);

}  // namespace rths::diagnosis
