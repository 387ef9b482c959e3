// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>

#include "card_session.hpp"

namespace rths::scramnet {

inline constexpr std::size_t kTrapPage = 4096;  ///< [B]

/// Traps of stores through a pointer, on a replicated ring.
///
/// A page with a word that interrupts, triggers, is HIPRO or is not the node's own can only be read
/// through the window; in write-me-last, with host writes off, or if all words interrupt, so can
/// every page. A store there
/// raises a signal. Its handler makes the store itself, through another mapping, and queues it for
/// the thread that carries messages: with its order, value, width and number. An instruction that
/// it does not know is executed with the page open, and the 64 bytes behind its address are
/// compared. The handler does not allocate or lock. It waits only if the queue is full, as a card
/// holds off its host. x86-64 only.
class Traps {
 public:
  /// @param wanted  by the settings
  Traps(const CardSession& session, bool wanted);
  Traps(const Traps&) = delete;
  Traps& operator=(const Traps&) = delete;

  /// The window and the memory behind it: called when it was mapped, with all pages open.
  struct Window {
    std::byte* window = nullptr;  ///< null: it is not mapped
    std::byte* memory = nullptr;
    std::uint64_t offset = 0, bytes = 0;  ///< on the ring
    bool shows_acr = false;
  };
  void set_window(const Window& window);
  /// True if ACR or registers have changed since `follow`.
  [[nodiscard]] bool is_due() const;
  /// Closes and opens pages as ACR and registers need it now.
  void follow();
  /// The same after one change of the ACR, to the word of this byte of the window.
  void follow_word(std::uint64_t offset);
  /// True if the window's page of this byte is closed.
  [[nodiscard]] bool is_closed(std::uint64_t offset) const;
  /// The store of a block call to closed pages.   @any_thread
  void store(std::uint64_t offset, const std::byte* from, std::uint64_t bytes);
  /// True if `follow` would open a page. Then earlier stores must have been carried first.
  [[nodiscard]] bool opens_a_page() const;

 private:
  [[nodiscard]] bool is_wanted(std::uint64_t page) const;
  [[nodiscard]] bool all_wanted() const;
  void update(std::uint64_t page);

  const CardSession* session_;
  bool active_;
  std::mutex mutex_;  ///< of `follow` and `set_window`
  std::atomic<std::uint32_t> acr_changes_{0};
  std::atomic<bool> all_{false}, changed_{true};
};

}  // namespace rths::scramnet
