// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <string>

#include <rths/memmap/map.hpp>

namespace rths::broker {

/// A map with a tear group of each kind and single words, of two nodes.
[[nodiscard]] memmap::Map map_to_damage();

/// Bytes of a ring's object up to the end of the journals, and the size of the object.
struct RingImage {
  std::string bytes;
  std::uint64_t size = 0;
};

/// A ring on which both nodes have written; one of them has died, the other one has left.
[[nodiscard]] RingImage ring_to_damage();

/// The same ring with damage: random bytes; values of header, slots, groups, records, map and
/// journals that are huge, negative, off by one or overlapping; other sizes of the object. The same
/// seed gives the same damage.
[[nodiscard]] RingImage damaged(RingImage image, std::uint64_t seed);

/// Replaces the object of a ring by this image.
void install(const RingImage& image, const std::string& ring);

}  // namespace rths::broker
