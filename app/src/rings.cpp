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
    fmt::print("  {:<12} process {:<8} {} ({} heartbeats)\n", occupant.node, occupant.pid,
               occupant.alive ? "alive" : "ended without leaving; its slot is free",
               occupant.beats);
  for (const auto& group : ring.torn_groups)
    fmt::print(
        "  partition '{}' has an unfinished write; readers get the last complete one, and the next "
        "node of the same name repairs it\n",
        group);
  if (!ring.in_use()) fmt::print("  no process uses it; 'rths clean' removes it\n");
}

}  // namespace

int doctor() {
  const auto rings = broker::list_rings();
  bool any_unused = false;
  for (const auto& ring : rings) {
    describe(ring);
    any_unused = any_unused || !ring.in_use();
  }
  if (rings.empty()) fmt::print("no rings\n");
  const std::string missing = launch::missing_privileges();
  fmt::print("real time: {}\n",
             missing.empty() ? "scheduling and memory locking are available" : missing);
  return any_unused ? kConditionNotMet : kOk;
}

int clean() {
  int result = kOk;
  for (const auto& ring : broker::list_rings()) {
    if (ring.in_use()) continue;
    if (!ring.foreign && broker::remove_ring(ring.name)) {
      fmt::print("removed {}\n", ring.name);
    } else {
      fmt::print("kept {}: {}\n", ring.name, ring.foreign ? ring.trouble : "cannot be removed");
      result = kConditionNotMet;
    }
  }
  return result;
}

}  // namespace rths::app
