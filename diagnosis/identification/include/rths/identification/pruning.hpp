// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

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

}  // namespace rths::diagnosis
