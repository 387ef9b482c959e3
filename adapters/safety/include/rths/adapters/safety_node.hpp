// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/adapters/safe_machine.hpp>
#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// Puts the safety layer in front of a machine, unless the table says `enabled = false`.
/// @param machine  settings of the machine alone
/// @param words    of its axes, in the order long, lat, vert; none: those of the tested axes by
///                 role
/// @param table    [node.<name>.safety]: the file of the limits, and changes of them
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings with_safety(experiment::NodeSettings machine,
                                                   const Config& table,
                                                   const experiment::Experiment& setup,
                                                   const std::vector<MachineAxis>& words = {});

}  // namespace rths::adapters
