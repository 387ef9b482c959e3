// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <rths/cases/case.hpp>
#include <rths/identification/relation.hpp>

#include "dynamic_model.hpp"
#include "dynamic_run.hpp"

namespace rths::diagnosis {

/// A record prepared for a dynamic model.
class DynamicDrive : public Drive {
 public:
  DynamicSignals signals;
};

/// @param base  the simulation as stated: a search for a free start begins at its state
/// @throws Error if the record lacks a channel of the model, or its sampling rate differs from that
///         of a model in discrete time   @setup
[[nodiscard]] std::unique_ptr<DynamicDrive> dynamic_drive(const DynamicModel& model,
                                                          const Hypothesis& base,
                                                          const Record& record);

/// The drive with noise added to its channels.
[[nodiscard]] std::unique_ptr<DynamicDrive> with_noise(const DynamicModel& model,
                                                       const DynamicDrive& drive,
                                                       const Record& noise);

/// @throws Error if the channel was not recorded
[[nodiscard]] const Channel& channel_of(const Record& record, const std::string& role);

}  // namespace rths::diagnosis
