// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/identification/relation.hpp>

#include "dynamic_model.hpp"
#include "dynamic_sizes.hpp"

namespace rths::diagnosis {

/// Terms of free shape between the points of a model: they describe an effect without a name. They
/// act on the predicted motion, so they are proven like any other term.
[[nodiscard]] std::vector<FreeForm> dynamic_forms(const DynamicModel& model,
                                                  const DynamicSizes& sizes);

/// Candidates for a dynamic system: terms at its inputs, between its points and at its outputs, and
/// parameters of its linear system that were not fitted.
[[nodiscard]] std::vector<Candidate> dynamic_candidates(const DynamicModel& model,
                                                        const DynamicSizes& sizes,
                                                        const Hypothesis& base);

/// A free parameter of a term, within the catalogue's bounds.
/// @param size  a change that matters [SI]; 0: a tenth of the typical value
[[nodiscard]] FreeParameter free_parameter(const std::string& name, const sim::Parameter& parameter,
                                           const UnitScales& scales, double size);

}  // namespace rths::diagnosis
