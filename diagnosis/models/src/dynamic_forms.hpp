// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/identification/relation.hpp>

#include "dynamic_model.hpp"
#include "dynamic_sizes.hpp"

namespace rths::diagnosis {

/// Terms of free shape between the points of a model: they describe an effect without a name. They
/// act on the predicted motion, so they are proven like any other term.
[[nodiscard]] std::vector<FreeForm> dynamic_forms(const DynamicModel& model,
                                                  const DynamicSizes& sizes);

}  // namespace rths::diagnosis
