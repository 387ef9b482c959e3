// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

/// Checks the keys of a model of a bearing, platen or axis, and the names of its fitted parameters.
/// @throws Error file:line:column, with the nearest known name   @setup
void check_composed_model(const Case& c);

/// Whether a term of a model of a bearing or platen depends on rates or times.   @setup
[[nodiscard]] bool has_terms_of_time(const Case& c);

/// Whether the model has an actuator, which predicts displacements from commands.   @setup
[[nodiscard]] bool has_actuator(const Case& c);

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
