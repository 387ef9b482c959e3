// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <cstdint>

namespace rths {

/// A count or an index as a type of its own: no implicit conversion to or from other numbers.
template <class Tag, class Integer>
class StrongId {
 public:
  using value_type = Integer;
  constexpr StrongId() = default;
  constexpr explicit StrongId(Integer value) noexcept : value_{value} {}
  [[nodiscard]] constexpr Integer value() const noexcept { return value_; }
  friend constexpr auto operator<=>(StrongId, StrongId) = default;

 private:
  Integer value_{};
};

/// Position of a 32-bit longword in the ring's memory, counted from 0.
using LongwordOffset = StrongId<struct LongwordOffsetTag, std::uint32_t>;
/// Position of a byte in the ring's memory, counted from 0.
using ByteOffset = StrongId<struct ByteOffsetTag, std::uint32_t>;
/// Position of a longword counted from 1, as on laboratory sheets.
using Location = StrongId<struct LocationTag, std::uint32_t>;
/// A member of the ring.
using NodeId = StrongId<struct NodeIdTag, std::uint16_t>;
/// A signal of a memory map: index into the map's list of signals.
using SignalId = StrongId<struct SignalIdTag, std::uint32_t>;
/// A tear group of a memory map: index into the map's list of groups.
using TearGroupId = StrongId<struct TearGroupIdTag, std::uint32_t>;
/// Number of cycles of a periodic event.
using CycleCount = StrongId<struct CycleCountTag, std::uint64_t>;

inline constexpr std::uint32_t kBytesPerLongword = 4;

[[nodiscard]] constexpr ByteOffset to_byte_offset(LongwordOffset offset) noexcept {
  return ByteOffset{offset.value() * kBytesPerLongword};
}
[[nodiscard]] constexpr Location to_location(LongwordOffset offset) noexcept {
  return Location{offset.value() + 1};
}
/// @pre location ≥ 1
[[nodiscard]] constexpr LongwordOffset to_longword_offset(Location location) noexcept {
  return LongwordOffset{location.value() - 1};
}
/// @pre the byte offset is a multiple of four; see `is_aligned`
[[nodiscard]] constexpr LongwordOffset to_longword_offset(ByteOffset offset) noexcept {
  return LongwordOffset{offset.value() / kBytesPerLongword};
}
[[nodiscard]] constexpr bool is_aligned(ByteOffset offset) noexcept {
  return offset.value() % kBytesPerLongword == 0;
}
[[nodiscard]] constexpr LongwordOffset advance(LongwordOffset offset,
                                               std::uint32_t longwords) noexcept {
  return LongwordOffset{offset.value() + longwords};
}

}  // namespace rths
