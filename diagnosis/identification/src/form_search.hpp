// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/identification/forms.hpp>

namespace rths::diagnosis {

/// Energy of the residual beyond the noise on a fold, at least kLeastExcess.
[[nodiscard]] double excess_on(const TestedHypothesis& tested, const Fold& fold);

/// Adds curves and surfaces over the measured states that drive the prediction, by regression.
void regress_forms(const TestedHypothesis& tested, const Folds& folds,
                   std::vector<Description>& found);

/// Adds terms of free shape that act on the predicted state. Those with the best linearised effect
/// are fitted to one fold and simulated on the other.
void fit_forms(const TestedHypothesis& tested, const Folds& folds,
               const std::vector<FreeForm>& forms, std::vector<Description>& found);

/// Adds a sine of one frequency in the residuals of both folds.
void find_periodic_force(const TestedHypothesis& tested, const Folds& folds,
                         std::vector<Description>& found);

/// Adds the sudden change of a parameter that explains most, found on each record separately.
void find_change(const TestedHypothesis& tested, const Folds& folds,
                 std::vector<Description>& found);

/// Adds pieces of the records in which a measured output holds its value while the predicted one
/// moves.
void find_held_samples(const TestedHypothesis& tested, const Folds& folds,
                       std::vector<Description>& found);

}  // namespace rths::diagnosis
