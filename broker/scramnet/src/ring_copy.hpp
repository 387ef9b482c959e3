// SPDX-License-Identifier: Apache-2.0
//
// Copies between the ring and private memory. std::memcpy may move a longword in pieces, and others
// write the same words meanwhile. So each longword is moved by one access, in ascending order.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace rths::scramnet {

/// Reads a unit of the ring by one access.
/// @pre the address is aligned to the unit   @realtime
template <class Unit>
[[nodiscard]] Unit read_ring_unit(const std::byte* from) noexcept {
  auto* unit = const_cast<Unit*>(reinterpret_cast<const Unit*>(from));
  return std::atomic_ref{*unit}.load(std::memory_order_acquire);
}
/// Writes a unit of the ring by one access.
/// @pre the address is aligned to the unit   @realtime
template <class Unit>
void write_ring_unit(std::byte* to, Unit unit) noexcept {
  std::atomic_ref{*reinterpret_cast<Unit*>(to)}.store(unit, std::memory_order_release);
}

/// Copies whole units from the ring to private memory of any alignment.
template <class Unit>
void read_ring_units(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  for (std::size_t i = 0; i < bytes; i += sizeof(Unit)) {
    const auto unit = read_ring_unit<Unit>(from + i);
    std::memcpy(to + i, &unit, sizeof unit);
  }
}
/// Copies whole units from private memory of any alignment to the ring.
template <class Unit>
void write_ring_units(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  for (std::size_t i = 0; i < bytes; i += sizeof(Unit)) {
    Unit unit;
    std::memcpy(&unit, from + i, sizeof unit);
    write_ring_unit(to + i, unit);
  }
}

/// A block of the ring, divided at its longwords: bytes, whole longwords, bytes.
struct RingBlock {
  std::size_t head, whole, tail;  ///< [B]

  RingBlock(const std::byte* begin, std::size_t bytes) noexcept
      : head{std::min(bytes, -reinterpret_cast<std::uintptr_t>(begin) % 4)},
        whole{(bytes - head) / 4 * 4},
        tail{bytes - head - whole} {}
};

/// Copies a block from the ring. Only the longwords that it cuts are read byte by byte.
inline void read_ring(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  const RingBlock block{from, bytes};
  read_ring_units<std::uint8_t>(to, from, block.head);
  to += block.head, from += block.head;
  read_ring_units<std::uint32_t>(to, from, block.whole);
  read_ring_units<std::uint8_t>(to + block.whole, from + block.whole, block.tail);
}
/// Copies a block to the ring. Only the longwords that it cuts are written byte by byte.
inline void write_ring(std::byte* to, const std::byte* from, std::size_t bytes) noexcept {
  const RingBlock block{to, bytes};
  write_ring_units<std::uint8_t>(to, from, block.head);
  to += block.head, from += block.head;
  write_ring_units<std::uint32_t>(to, from, block.whole);
  write_ring_units<std::uint8_t>(to + block.whole, from + block.whole, block.tail);
}

}  // namespace rths::scramnet
