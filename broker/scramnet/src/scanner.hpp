// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "card_session.hpp"

namespace rths::scramnet {

/// Detects writes to words that interrupt this card.
///
/// A store through a pointer cannot be intercepted. So a scan compares the words with RIE in this
/// card's ACR with their values at the last scan. A change is an interrupt if a card that may have
/// made it has TIE for the word. A scan takes about 1 ns per word. Calls that wait for an interrupt
/// or read the FIFO scan; a thread scans only while a process is registered for a signal. A word
/// that is written twice between two scans counts once; a store of the same value does not count.
class Scanner {
 public:
  /// Time between two scans, of a waiting call and of the thread [ns].
  static constexpr long kPeriodNs = 50'000;
  static constexpr long kLongestSleepNs = 10'000'000;

  Scanner(const CardSession& session, const Word* words, std::uint32_t longwords)
      : session_{&session}, words_{words}, longwords_{longwords} {}
  ~Scanner() { run_thread(false); }
  Scanner(const Scanner&) = delete;
  Scanner& operator=(const Scanner&) = delete;

  /// True if this card receives memory interrupts.
  [[nodiscard]] bool is_enabled() const;
  /// Scans once and delivers the interrupts found. Does not scan if another process is scanning for
  /// this card. Blocks all signals meanwhile, so a signal handler may call it.   @any_thread
  void scan();
  /// Takes the current values as the baseline; called when interrupts are enabled.
  void reset();
  /// The same for one word, when its ACR is set.
  void reset(std::uint32_t longword);
  /// Starts or stops the thread that scans; it has real-time scheduling if the process may have it.
  void run_thread(bool wanted);
  /// Sets the words to scan. @param network_longword  offset of the first word on the ring, which
  /// virtual paging changes
  void set_window(const Word* words, std::uint32_t longwords, std::uint32_t network_longword);

 private:
  class ScanLock;
  void compare();
  void rebuild_if_changed();
  [[nodiscard]] bool raises_interrupt(std::uint32_t longword) const;
  void set_baseline(std::uint32_t longword);

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
