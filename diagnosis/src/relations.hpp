// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <rths/diagnosis/diagnose.hpp>

#include "relation.hpp"

namespace rths::diagnosis {

/// Records for fitting and proof, without reference records.
[[nodiscard]] std::vector<const Record*> moving_records(const Case& c);

/// Displacement ↔ acceleration, for each axis that has both; null if none has.
[[nodiscard]] std::unique_ptr<Relation> accelerometer_relation(const Case& c,
                                                               const DiagnosisOptions& options);
/// Command → displacement; null if the case has no command or its model has no actuator.
[[nodiscard]] std::unique_ptr<Relation> actuator_relation(const Case& c,
                                                          const DiagnosisOptions& options);
/// Motion → force; null for a model of a servo-hydraulic axis.
[[nodiscard]] std::unique_ptr<Relation> force_relation(const Case& c,
                                                       const DiagnosisOptions& options);

}  // namespace rths::diagnosis
