// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/diagnosis/case.hpp>

#include "dynamic_model.hpp"
#include "dynamic_run.hpp"
#include "relation.hpp"

namespace rths::diagnosis {

/// A record as a dynamic model looks at it.
class DynamicDrive : public Drive {
 public:
  DynamicSignals signals;
};

/// @param base  what the simulation assumed: tells the first state where it is free
/// @throws Error if the record lacks a channel of the model, or is sampled at another rate than a
///         model in discrete time   @setup
[[nodiscard]] std::unique_ptr<DynamicDrive> dynamic_drive(const DynamicModel& model,
                                                          const Hypothesis& base,
                                                          const Record& record);

/// The same with noise on its channels.
[[nodiscard]] std::unique_ptr<DynamicDrive> with_noise(const DynamicModel& model,
                                                       const DynamicDrive& drive,
                                                       const Record& noise);

/// @throws Error if it was not recorded
[[nodiscard]] const Channel& channel_of(const Record& record, const std::string& role);

}  // namespace rths::diagnosis
