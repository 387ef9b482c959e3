// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/broker/ring.hpp>

namespace rths::broker {

/// Writes words by name, each as the node that owns it, which is on the ring meanwhile.
/// @param assignments  "name=value", optionally with a unit: "12.5mm"; default: the map's
/// @throws Error if a name, value or unit is wrong, before anything is written, or if an owner is
///         on the ring already   @setup
void assign(Ring& ring, const std::vector<std::string>& assignments);

}  // namespace rths::broker
