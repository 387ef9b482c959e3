// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <unistd.h>

#include <rths/broker/ring.hpp>
#include <rths/memmap/map.hpp>

namespace rths::test {

/// Words of the small map.
inline constexpr LongwordOffset kMachineWord{500};
inline constexpr LongwordOffset kControllerWord{512};

/// A small map: a machine with a tear group of `group` words at 0 and a single word at 500, and a
/// controller with single words from 512.
inline memmap::Map small_map(std::uint32_t group = 8) {
  memmap::MapDescription description;
  description.name = "small";
  description.size_longwords = 1024;
  description.nodes = {{"machine", NodeId{1}, ""}, {"controller", NodeId{2}, ""}};
  memmap::Partition feedback;
  feedback.name = "fbk";
  feedback.node = "machine";
  feedback.base = LongwordOffset{0};
  feedback.longwords = group;
  feedback.tear_group = true;
  memmap::Partition loose;
  loose.name = "echo";
  loose.node = "machine";
  loose.base = kMachineWord;
  loose.longwords = 1;
  memmap::Partition reference;
  reference.name = "ref";
  reference.node = "controller";
  reference.base = kControllerWord;
  reference.longwords = 4;
  memmap::Signal signal;
  signal.name = "long";
  signal.unit = "mm";
  signal.initial = 2.5;
  signal.offset = kControllerWord;
  reference.signals = {signal};
  description.partitions = {feedback, loose, reference};
  return memmap::Map{description};
}

/// A ring name that is unique to this process.
inline std::string unique_ring(const std::string& test) {
  return "test_" + test + "_" + std::to_string(getpid());
}

/// Removes a ring in its destructor.
struct RingRemoval {
  std::string name;
  ~RingRemoval() { broker::remove_ring(name); }
};

}  // namespace rths::test
