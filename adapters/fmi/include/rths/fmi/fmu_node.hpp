// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::fmi {

/// A Functional Mock-up Unit of FMI 2 or 3 for co-simulation. Keys: file, signals, units, start,
/// tunable, ramp, log, and those of every plugin: role, own_process, deadline_s, allocates.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_fmu(const std::string& node, const Config& table,
                                                const experiment::Experiment& setup);

}  // namespace rths::fmi
