// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths_adapter.h>

#include <rths/core/config.hpp>

#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// An FMU behind the interface of plugins. Its config has the keys `folder` (of the unpacked FMU),
/// `instance` and `step_s`, and those of the node: see `read_fmu`.
[[nodiscard]] const rths_adapter& fmu_adapter();

/// An instance of an FMU.
struct InstancePlan {
  std::filesystem::path folder;  ///< of the unpacked FMU
  std::string instance;          ///< its name
  double period = 1e-3;          ///< of its steps [s]
};

/// The config of `fmu_adapter`.
/// @param table  of the node, with all its signals
/// @throws Error if the FMU cannot make steps of this length   @setup
[[nodiscard]] std::string config_of(const ModelDescription& description, Config table,
                                    const InstancePlan& plan);

}  // namespace rths::fmi
