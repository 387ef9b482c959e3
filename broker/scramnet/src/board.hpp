// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>

#include "card_session.hpp"
#include "complaint.hpp"
#include "registers.hpp"
#include "scanner.hpp"
#include "settings.hpp"

namespace rths::scramnet {

/// The SCRAMNet+ card that this process holds, with its windows into the memory.
///
/// Programs see the ring's memory through a window that stays at one address while it is mapped.
/// It shows the ACR instead while CSR0 says so, and another page of a larger ring if virtual
/// paging does, by mapping other pages at that address: loads and stores have no software in
/// their path. Any thread may call; what the vendor's calls do in several steps is as little
/// atomic as on the card.
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
  [[nodiscard]] bool is_mapped() const { return window_ != nullptr; }
  [[nodiscard]] std::byte* window() const { return window_; }
  /// What a real card of that size code would have.
  [[nodiscard]] std::uint64_t card_bytes() { return bytes_of_size_code(size_code_); }
  [[nodiscard]] std::uint64_t window_bytes() const { return window_bytes_; }
  /// The memory that the window shows, and the ACR, whatever the window shows.
  [[nodiscard]] std::byte* memory() const { return memory_ + page_offset_; }
  [[nodiscard]] Word* acr() const { return session_.own().acr; }
  void write_acr(std::uint32_t longword, std::uint32_t value);
  void clear_acr();
  /// Whether the ring has the page that CSR12 would select.
  [[nodiscard]] bool has_page(std::uint32_t page) const;
  /// Whether another card on the ring is receiving or transmitting.
  [[nodiscard]] bool others_are_at_work() const;

  /// Host interrupts delivered since the last time this process asked.
  [[nodiscard]] std::uint32_t take_interrupts();
  void update_thread();
  void leave();

 private:
  void control_changed(std::uint32_t before);
  void warn_of_shared_id();
  void show();

  CardSession session_;
  bool bypass_switch_;
  std::uint64_t window_bytes_;
  std::uint32_t size_code_;
  std::byte* memory_;
  std::byte* window_ = nullptr;
  std::uint64_t page_offset_ = 0;
  std::atomic<std::uint32_t> interrupts_seen_;
  Scanner scanner_;
};

/// Why a card is not to be had, as the vendor's calls number it.
enum class BoardError { None = 0, Configuration = -1, Memory = -3, Driver = -4 };

/// The card of this process, or null if it has taken none.
[[nodiscard]] Board* board() noexcept;
/// The same, taken now if need be. Says on standard error, once, why it cannot be had.
[[nodiscard]] Board* take_board(BoardError& error) noexcept;
}  // namespace rths::scramnet
