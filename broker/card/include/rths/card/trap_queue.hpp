// SPDX-License-Identifier: Apache-2.0
//
// The queue between the traps of a host and the thread that carries its messages. A host reserves
// entries, announces their addresses, stores to the memory, then publishes the values. So a scan
// that finds a changed word finds the word among the announced entries, too, and leaves it to them.
// No call waits; a host may be stopped at any point.
#pragma once

#include <optional>

#include <rths/card/card.hpp>

namespace rths::scramnet {

/// Stamps of entry n; no other entry, nor an earlier lap of its slot, has them.
[[nodiscard]] constexpr std::uint32_t announced(std::uint32_t n) { return 2 * n + 1; }
[[nodiscard]] constexpr std::uint32_t published(std::uint32_t n) { return 2 * n + 2; }

[[nodiscard]] inline TrapEntry& entry_of(TrapQueue& queue, std::uint32_t n) {
  return queue.entries[n % kTrapEntries];
}

/// Reserves entries that follow each other. @returns the number of the first; empty if the queue
/// has no space
[[nodiscard]] inline std::optional<std::uint32_t> reserve(TrapQueue& queue, std::uint32_t count) {
  std::uint32_t first = queue.reserved.load();
  do {
    if (first + count - queue.taken.load() > kTrapEntries) return std::nullopt;
  } while (!queue.reserved.compare_exchange_weak(first, first + count));
  return first;
}

/// @param address  address on the ring [B]
inline void announce(TrapQueue& queue, std::uint32_t n, std::uint32_t address) {
  entry_of(queue, n).address.store(address);
  entry_of(queue, n).stamp.store(announced(n));
}

/// @param form  of TrapEntry; 0: nothing was stored
inline void publish(TrapQueue& queue, std::uint32_t n, std::uint32_t form, std::uint32_t value) {
  TrapEntry& entry = entry_of(queue, n);
  entry.form.store(form);
  entry.value.store(value);
  entry.stamp.store(published(n));
}

/// True if a trap that is not taken yet may have changed this longword.
[[nodiscard]] inline bool may_change(TrapQueue& queue, std::uint32_t longword) {
  const std::uint32_t end = queue.reserved.load();
  for (std::uint32_t n = queue.taken.load(), i = 0; n != end && i < kTrapEntries; ++n, ++i) {
    const TrapEntry& entry = entry_of(queue, n);
    const std::uint32_t stamp = entry.stamp.load();
    if (stamp != announced(n) && stamp != published(n)) return true;  // reserved a moment ago
    if (entry.address.load() / 4 == longword) return true;
  }
  return false;
}

}  // namespace rths::scramnet
