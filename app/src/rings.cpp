// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/launch/privileges.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

void describe(const broker::RingReport& ring) {
  if (!ring.usable) {
    fmt::print("{}: {} bytes: {}\n", ring.name, ring.bytes, ring.trouble);
    return;
  }
  fmt::print("{}: {} bytes, map '{}' version {} {}\n", ring.name, ring.bytes, ring.map_name,
             ring.map_version, ring.map_hash);
  for (const auto& occupant : ring.occupants)
    fmt::print("  {:<12} process {:<8} {} ({} beats)\n", occupant.node, occupant.pid,
               occupant.alive ? "alive" : "ended without leaving; its place is free",
               occupant.beats);
  for (const auto& group : ring.torn_groups)
    fmt::print(
        "  partition '{}' was left in the middle of a write; readers get the last complete one, "
        "and "
        "the next node of its name mends it\n",
        group);
  if (!ring.in_use()) fmt::print("  nobody is on it: 'rths clean' removes it\n");
}

}  // namespace

int doctor() {
  const auto rings = broker::list_rings();
  bool something_to_do = false;
  for (const auto& ring : rings) {
    describe(ring);
    something_to_do = something_to_do || !ring.in_use();
  }
  if (rings.empty()) fmt::print("no rings\n");
  const std::string missing = launch::missing_privileges();
  fmt::print("real time: {}\n",
             missing.empty() ? "scheduling and locked memory are to be had" : missing);
  return something_to_do ? kConditionNotMet : kOk;
}

int clean() {
  int result = kOk;
  for (const auto& ring : broker::list_rings()) {
    if (ring.in_use()) continue;
    if (!ring.foreign && broker::remove_ring(ring.name)) {
      fmt::print("removed {}\n", ring.name);
    } else {
      fmt::print("left {}: {}\n", ring.name,
                 ring.foreign ? ring.trouble : "it could not be removed");
      result = kConditionNotMet;
    }
  }
  return result;
}

}  // namespace rths::app
