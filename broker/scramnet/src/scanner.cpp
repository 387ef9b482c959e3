// SPDX-License-Identifier: Apache-2.0
#include "scanner.hpp"

#include <pthread.h>
#include <sys/prctl.h>

#include <algorithm>
#include <csignal>
#include <ctime>

#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/interrupts.hpp>
#include <rths/card/monotonic_time.hpp>
#include <rths/card/registers.hpp>

namespace rths::scramnet {
namespace {

// Sleeps for a period, or as long as the scan took: it uses at most half of a processor.
void sleep_after_scan(std::int64_t scan_ns) {
  const timespec period{0, static_cast<long>(std::clamp<std::int64_t>(scan_ns, Scanner::kPeriodNs,
                                                                      Scanner::kLongestSleepNs))};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &period, nullptr);
}

// The thread's scans are exact on a busy host only with real-time scheduling. Without the privilege
// it keeps normal scheduling.
void prefer_real_time() {
  const sched_param lowest{1};
  static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest));
  prctl(PR_SET_TIMERSLACK, 1000UL);
}

bool receives(const Registers& registers) {
  return registers.all_set(0, csr0::kReceive | csr0::kMemoryInterrupts);
}

bool sends_interrupt(CardSession::CardView card, std::uint32_t longword) {
  return Registers{*card.card}.sends_interrupt(card.acr[longword].load());
}

}  // namespace

// Lock for a scan: among the threads of this process, then among the processes of this card. Blocks
// signals while it is held, so that a handler never waits for the thread that it interrupted.
class Scanner::ScanLock {
 public:
  explicit ScanLock(Scanner& scanner) : claim_{&scanner.session_->card().plus.scanner} {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
    lock_ = std::unique_lock{scanner.mutex_};
    const broker::Claim self = scanner.session_->self();
    broker::Claim holder = claim_->load();
    if (holder != self && scanner.session_->members().has(holder)) return;
    held_ = claim_->compare_exchange_strong(holder, self);
  }
  ~ScanLock() {
    if (held_) claim_->store(0);
    lock_.unlock();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  ScanLock(const ScanLock&) = delete;
  ScanLock& operator=(const ScanLock&) = delete;
  [[nodiscard]] bool is_held() const { return held_; }

 private:
  SharedClaim* claim_;
  sigset_t before_{};
  std::unique_lock<std::mutex> lock_;
  bool held_ = false;
};

bool Scanner::is_enabled() const {
  return session_->card().carried.active.load() == 0 && receives(Registers{session_->card()});
}

void Scanner::scan() {
  if (is_enabled()) {
    const ScanLock lock{*this};
    if (lock.is_held()) compare();
  }
  deliver_if_due(session_->card(), session_->members());
}

void Scanner::compare() {
  rebuild_if_changed();
  const auto& own = session_->own();
  const auto check = [&](std::uint32_t longword) {
    const std::uint32_t word = words_[longword].load(std::memory_order_acquire);
    if (word == own.known[longword].load(std::memory_order_relaxed)) return;
    own.known[longword].store(word, std::memory_order_relaxed);
    if (!raises_interrupt(longword)) return;
    if (!push(own.card->plus.fifo, (network_longword_ + longword) * 4))
      Registers{*own.card}.latch(csr1::kInterruptFifoFull);
  };
  if (watches_all_)
    for (std::uint32_t longword = 0; longword < longwords_; ++longword) check(longword);
  else
    for (const std::uint32_t longword : watched_) check(longword);
}

// The writer of a word is unknown. The write counts as foreign if another card sends interrupts for
// the word, as own if only this card does.
bool Scanner::raises_interrupt(std::uint32_t longword) const {
  const auto& own = session_->own();
  const Registers registers{*own.card};
  const std::uint32_t network = network_longword_ + longword;
  const std::uint32_t acr = own.acr[longword].load();
  bool found = registers.all_set(8, csr8::kAllInterrupt) ||
               registers.accepts_interrupt(acr, true, sends_interrupt(own, longword));
  session_->for_each_card([&](const CardSession::CardView& card) {
    if (card.card != own.card && network < session_->memory_bytes() / 4)
      found |= registers.accepts_interrupt(acr, false, sends_interrupt(card, network));
  });
  return found;
}

void Scanner::rebuild_if_changed() {
  const auto& own = session_->own();
  const bool all = Registers{*own.card}.all_set(0, csr0::kAllReceiveInterrupts);
  const std::uint32_t changes = own.card->plus.acr_changes.load();
  if (has_list_ && changes == acr_changes_ && all == watches_all_) return;
  watched_.clear();
  for (std::uint32_t longword = 0; !all && longword < longwords_; ++longword)
    if ((own.acr[longword].load(std::memory_order_relaxed) & acr::kReceiveInterrupt) != 0)
      watched_.push_back(longword);
  acr_changes_ = changes;
  watches_all_ = all;
  has_list_ = true;
}

// If memory for the last value is short, the word cannot be scanned: clears its ACR bit.
void Scanner::set_baseline(std::uint32_t longword) {
  const auto& own = session_->own();
  if (session_->reserve_known(longword, 1))
    own.known[longword].store(words_[longword].load());
  else
    own.acr[longword].fetch_and(~acr::kReceiveInterrupt);
}

void Scanner::reset() {
  const ScanLock lock{*this};
  if (!lock.is_held()) return;
  has_list_ = false;
  rebuild_if_changed();
  for (const std::uint32_t longword : watched_) set_baseline(longword);
  if (!watches_all_ || !session_->reserve_known(0, longwords_)) return;
  for (std::uint32_t i = 0; i < longwords_; ++i) session_->own().known[i].store(words_[i].load());
}

void Scanner::reset(std::uint32_t longword) {
  const ScanLock lock{*this};
  if (lock.is_held()) set_baseline(longword);
}

void Scanner::set_window(const Word* words, std::uint32_t longwords, std::uint32_t network) {
  const ScanLock lock{*this};
  words_ = words;
  longwords_ = longwords;
  network_longword_ = network;
  has_list_ = false;
}

void Scanner::run_thread(bool wanted) {
  if (wanted == thread_.joinable()) return;
  stop_.store(!wanted);
  if (!wanted) return thread_.join();
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // the thread inherits the mask: handles no signals
  thread_ = std::thread{[this] {
    prefer_real_time();
    while (!stop_.load()) {
      const std::int64_t begun = now_ns();
      scan();
      sleep_after_scan(now_ns() - begun);
    }
  }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace rths::scramnet
