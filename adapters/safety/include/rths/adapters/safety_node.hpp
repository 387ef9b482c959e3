// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/adapters/factory.hpp>

namespace rths::adapters {

/// Puts the safety layer in front of a machine, unless the table says `enabled = false`. The layer
/// works on the words of TestSetup::machine_axes.
/// @param machine  settings of the machine alone
/// @param drives_vertical  it moves by xpc.vert.displ.ref, too
/// @param table    [node.<name>.safety]: the file of the limits, and changes of them
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] NodeSettings with_safety(NodeSettings machine, const Config& table,
                                       const TestSetup& setup, bool drives_vertical = false);

}  // namespace rths::adapters
