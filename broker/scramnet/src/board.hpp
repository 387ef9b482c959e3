// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include <rths/card/registers.hpp>

#include "card_session.hpp"
#include "ring_copy.hpp"
#include "scanner.hpp"
#include "settings.hpp"
#include "traps.hpp"
#include "warning.hpp"

namespace rths::scramnet {

/// The SCRAMNet+ card of this process, with its window into the memory.
///
/// Programs access the ring's memory through a window that keeps its address while it is mapped.
/// CSR0 can select the ACR instead, and virtual paging another page of a larger ring: then other
/// pages are mapped at the same address, so loads and stores need no software. Any thread may
/// call. A vendor's call with several steps is not atomic, as on the card.
class Board {
 public:
  /// @throws Error
  explicit Board(const Settings& settings);

  [[nodiscard]] std::uint32_t read_csr(int index);
  void write_csr(int index, std::uint32_t value);
  void change_csr(int index, std::uint32_t set, std::uint32_t clear);
  [[nodiscard]] Registers registers() { return Registers{session_.card()}; }
  [[nodiscard]] PlusCard& plus() { return session_.card().plus; }
  [[nodiscard]] const CardSession& session() const { return session_; }
  [[nodiscard]] Scanner& scanner() { return scanner_; }

  [[nodiscard]] bool map_window();
  void unmap_window();
  [[nodiscard]] std::byte* window() const { return window_; }
  /// Memory of a real card with the same size code [B].
  [[nodiscard]] std::uint64_t card_bytes() { return bytes_of_size_code(size_code_); }
  [[nodiscard]] std::uint64_t window_bytes() const { return window_bytes_; }
  /// The memory page of the window and the ACR; both independent of the window's selection.
  [[nodiscard]] std::byte* memory() const { return memory_ + page_offset_; }
  [[nodiscard]] Word* acr() const { return session_.own().acr; }
  void write_acr(std::uint32_t longword, std::uint32_t value);
  void clear_acr();
  /// Sets all words of the ACR.
  void fill_acr(std::uint32_t value);
  /// To be called before a block call loads: in write-me-last, waits until the stores of this
  /// program have returned to its memory, at most 0.1 s.
  void wait_for_own_stores() const;
  /// A block call's stores. A unit has 1, 2 or 4 bytes.
  void store(std::uint64_t offset, const std::byte* from, std::uint64_t bytes);
  template <class Unit>
  void store_unit(std::uint64_t offset, Unit value) {
    if (traps_.is_closed(offset))
      traps_.store(offset, reinterpret_cast<const std::byte*>(&value), sizeof value);
    else
      write_ring_unit(memory() + offset, value);
  }
  /// True if the ring has this page, as CSR12 selects it.
  [[nodiscard]] bool has_page(std::uint32_t page) const;
  /// True if another card on the ring is receiving or transmitting.
  [[nodiscard]] bool others_are_active() const;

  /// Number of host interrupts delivered since this process's last call.
  [[nodiscard]] std::uint32_t take_interrupts();
  void update_thread();
  void leave();

 private:
  void wait_for_scan() const;
  void control_changed(std::uint32_t before);
  void warn_of_shared_id();
  void update_window();
  void update_traps();

  CardSession session_;
  bool bypass_switch_;
  std::uint64_t window_bytes_;
  std::uint32_t size_code_;
  std::byte* memory_;
  std::byte* window_ = nullptr;
  std::uint64_t page_offset_ = 0;
  std::atomic<std::uint32_t> interrupts_seen_;
  Scanner scanner_;
  Traps traps_;
};

/// Reason why no card could be taken, numbered as in the vendor's calls.
enum class BoardError { None = 0, Configuration = -1, Memory = -3, Driver = -4 };

/// The card of this process; null if it has taken none.
[[nodiscard]] Board* board() noexcept;
/// The card of this process; takes one if it has none. Prints the reason of a failure once.
[[nodiscard]] Board* take_board(BoardError& error) noexcept;
}  // namespace rths::scramnet
