// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Checks the names of fitted parameters of a bearing, platen or axis.
/// @throws Error file:line:column, with the nearest known name   @setup
void check_fitted(const Case& c);

/// Displacement ↔ acceleration, for each axis that has both; null if none has.
[[nodiscard]] std::unique_ptr<Relation> accelerometer_relation(
    const Case& c, const std::vector<std::string>& without);
/// Command → displacement; null if the case has no command or its model has no actuator.
[[nodiscard]] std::unique_ptr<Relation> actuator_relation(const Case& c,
                                                          const std::vector<std::string>& without);
/// Motion → force; null for a model of a servo-hydraulic axis.
[[nodiscard]] std::unique_ptr<Relation> force_relation(const Case& c,
                                                       const std::vector<std::string>& without);

}  // namespace rths::diagnosis
