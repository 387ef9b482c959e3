// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "card_session.hpp"

namespace rths::scramnet {

/// Finds out that a word which interrupts this card was written.
///
/// A store through a pointer tells nobody, so the words whose ACR has RIE here are compared with
/// what they were at the last look; a change counts if a card that may have made it has TIE there.
/// A look costs about a nanosecond per word. Who waits for an interrupt looks himself, as do calls
/// that read the FIFO; a thread looks only for those who asked for a signal. In between, a word
/// that was written twice counts once, and one that got the value it had does not count.
class Scanner {
 public:
  /// Between two looks, of those who wait and of the thread.
  static constexpr long kPeriodNs = 50'000;

  Scanner(const CardSession& session, const Word* words, std::uint32_t longwords)
      : session_{&session}, words_{words}, longwords_{longwords} {}
  ~Scanner() { run_thread(false); }
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// Whether this card takes memory interrupts at all.
  [[nodiscard]] bool is_enabled() const;
  /// One look, then delivery of what it found. Nothing if another process is looking for this
  /// card. Keeps all signals blocked meanwhile, so it may be called from a handler.   @any_thread
  void look();
  /// From here on counts only what changes after now: interrupts have just been enabled.
  void start_afresh();
  /// The same for one word, whose ACR has just been set.
  void start_afresh(std::uint32_t longword);
  void run_thread(bool wanted);
  /// Byte address of the card's first longword on the ring, after virtual paging.
  void set_window(const Word* words, std::uint32_t longwords, std::uint32_t network_longword);

 private:
  class Turn;
  void compare();
  void rebuild_if_changed();
  [[nodiscard]] bool somebody_interrupts(std::uint32_t longword) const;
  void remember(std::uint32_t longword);

  const CardSession* session_;
  std::mutex mutex_;  ///< between threads of this process only
  const Word* words_;
  std::uint32_t longwords_;
  std::uint32_t network_longword_ = 0;
  std::vector<std::uint32_t> watched_;
  std::uint32_t acr_changes_ = 0;
  bool watches_all_ = false, has_list_ = false;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

}  // namespace rths::scramnet
