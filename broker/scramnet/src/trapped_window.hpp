// SPDX-License-Identifier: Apache-2.0
//
// The window of this process as the handlers of its traps use it: no call allocates or locks.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <rths/card/store_instruction.hpp>
#include <rths/card/trap_queue.hpp>

#include "traps.hpp"

namespace rths::scramnet {

inline constexpr std::size_t kMostPages = 2048;  ///< of the largest card, 8 MB

class TrappedWindow {
 public:
  std::atomic<Card*> card{nullptr};
  std::atomic<std::byte*> window{nullptr};  ///< as the program sees it; null: not mapped
  std::atomic<bool> shows_acr{false};       ///< then all pages are open
  std::atomic<std::byte*> memory{nullptr};  ///< the same pages, always open
  std::atomic<std::uint64_t> offset{0};     ///< of the window on the ring [B]
  std::atomic<std::uint64_t> bytes{0};
  std::array<std::atomic<bool>, kMostPages> closed{};
  std::array<std::atomic<bool>, kMostPages> hidden{};  ///< cannot be loaded either

  /// Offset in the window of `length` bytes at an address; empty if they are not inside.
  [[nodiscard]] std::optional<std::uint64_t> find(std::uintptr_t address,
                                                  std::uint64_t length) const;
  /// Makes a store of up to 64 bytes. Waits for space in the queue.
  void store(std::uint64_t at, std::span<const std::uint8_t> value);
  /// Makes the store of an instruction that reads the memory first.
  /// @returns the value before
  std::uint64_t modify(std::uint64_t at, const StoreInstruction& instruction, const CpuState& cpu,
                       ReadModifyWrite& result);
  /// Entries for `count` longwords from this offset, announced; empty if there is no space in time.
  [[nodiscard]] std::optional<std::uint32_t> announce_words(std::uint64_t at, std::uint32_t count);
  /// Address from which `length` bytes at an address can be loaded: for those of the window, behind
  /// it, when its stores have gone around the ring.
  [[nodiscard]] const void* readable(std::uintptr_t address, std::uint64_t length);
  /// True if the card keeps the host's stores out of its memory.
  [[nodiscard]] bool withholds() const;
  void open_page(std::uint64_t at);
  void close_page(std::uint64_t at);  ///< if it is a closed one
  /// Waits until this host's stores have gone around the ring, then lets the page be loaded.
  void reveal(std::uint64_t at);
  [[nodiscard]] bool is_hidden(std::uint64_t at) const { return hidden[at / kTrapPage].load(); }

 private:
  [[nodiscard]] std::optional<std::uint32_t> reserve_in_time(std::uint32_t count);
  [[nodiscard]] bool writes_last() const;
  void hide(std::uint64_t at, std::uint64_t length);
  void protect(std::uint64_t at, int protection) const;

  std::atomic<bool> gave_up_{false};  ///< the last store found no space in time
};

/// The one of this process.
extern TrappedWindow trapped_window;

/// Installs the handlers.   @setup
void handle_traps() noexcept;

}  // namespace rths::scramnet
