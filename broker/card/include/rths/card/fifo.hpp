// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <rths/card/card.hpp>

namespace rths::scramnet {

/// Mark in an entry, whose lower two bits are no address: the message was a repetition.
inline constexpr std::uint32_t kRepeatedEntry = 0x1;

/// Adds the address of a longword. A full FIFO overwrites its newest entry and keeps the oldest
/// ones, as on the card. One process at a time.
/// @returns false if it was full
bool push(InterruptFifo& fifo, std::uint32_t byte_address) noexcept;
/// The oldest entry, without taking it.   @any_thread
[[nodiscard]] std::optional<std::uint32_t> peek(const InterruptFifo& fifo) noexcept;
/// Takes the oldest entry.   @any_thread
[[nodiscard]] std::optional<std::uint32_t> pop(InterruptFifo& fifo) noexcept;
void clear(InterruptFifo& fifo) noexcept;
[[nodiscard]] std::uint32_t size(const InterruptFifo& fifo) noexcept;

}  // namespace rths::scramnet
