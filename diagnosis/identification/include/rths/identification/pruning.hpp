// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/identification/forms.hpp>
#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// A candidate that was selected, but is not named.
struct Withdrawn {
  Candidate candidate;
  std::string reason;  ///< "its size may be zero"
};

/// Withdraws selected candidates that do not hold: all sizes together may be those of no effect, a
/// gap lies within the noise of the displacement, a held-out record is predicted worse with the
/// candidate than without it, or hardly better. Fits the model again after each.
/// @param held_out  records that were not used before; null: none
[[nodiscard]] std::vector<Withdrawn> prune(Problem& problem, const Problem* held_out,
                                           const Folds& folds, const SensorNoise& noise,
                                           Selection& selection);

/// Withdraws all selected candidates except rules of hysteresis. Fits the model after each.
[[nodiscard]] std::vector<Withdrawn> withdraw_all(Problem& problem, const Folds& folds,
                                                  const std::string& reason, Selection& selection);

/// Withdraws the candidate whose effect the best form of the residual explains as well, if that
/// form explains more than the candidate: an unknown effect resembles a term in part. Fits the
/// model again.
/// @param forms  of the residual of `selection.named`, best first
[[nodiscard]] std::optional<Withdrawn> withdraw_for_form(Problem& problem, const Folds& folds,
                                                         const std::vector<Description>& forms,
                                                         Selection& selection);

/// Withdraws a candidate whose fitted shape leaves several times the energy beyond the noise that a
/// free curve in its place leaves: the law is another one. A candidate of a size only stays, as an
/// idealisation that its users know. Fits the model again.
[[nodiscard]] std::optional<Withdrawn> withdraw_for_law(Problem& problem, const Folds& folds,
                                                        Selection& selection);

}  // namespace rths::diagnosis
