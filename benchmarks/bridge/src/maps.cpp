// SPDX-License-Identifier: Apache-2.0
#include "maps.hpp"

namespace rths::bench {
namespace {

memmap::Partition partition_of(const char* node, LongwordOffset base, std::uint32_t longwords) {
  memmap::Partition partition;
  partition.name = node;
  partition.node = node;
  partition.base = base;
  partition.longwords = longwords;
  return partition;
}

}  // namespace

memmap::Map small_map() {
  memmap::MapDescription description;
  description.name = "bridge_bench";
  description.size_longwords = 2048;
  description.nodes = {{"near", NodeId{1}, ""}, {"far", NodeId{2}, ""}};
  description.partitions = {partition_of("near", kNearWord, kStepWords),
                            partition_of("far", kFarWord, kStepWords)};
  return memmap::Map{std::move(description)};
}

memmap::Map image_map() {
  memmap::MapDescription description;
  description.name = "bridge_image";
  description.size_longwords = kImageLongwords;
  description.nodes = {{"near", NodeId{1}, ""}};
  description.partitions = {partition_of("near", LongwordOffset{0}, kImageLongwords)};
  return memmap::Map{std::move(description)};
}

}  // namespace rths::bench
