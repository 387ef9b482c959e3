// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "dynamic_model.hpp"
#include "dynamic_sizes.hpp"

namespace rths::diagnosis {

/// What a simulation of a dynamic system may have left out: terms at its inputs, between its
/// points and at its outputs, and numbers of its linear part that were not fitted.
[[nodiscard]] std::vector<Candidate> dynamic_candidates(const DynamicModel& model,
                                                        const DynamicSizes& sizes,
                                                        const Hypothesis& base);

/// A free parameter of a term at a place, in the catalogue's bounds.
[[nodiscard]] FreeParameter free_parameter(const std::string& name, const sim::Parameter& parameter,
                                           const UnitScales& scales, double size);

}  // namespace rths::diagnosis
