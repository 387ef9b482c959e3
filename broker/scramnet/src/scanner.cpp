// SPDX-License-Identifier: Apache-2.0
#include "scanner.hpp"

#include <sys/prctl.h>

#include <csignal>
#include <ctime>

#include "bits.hpp"
#include "fifo.hpp"
#include "interrupts.hpp"
#include "registers.hpp"

namespace rths::scramnet {
namespace {

void sleep_for_a_period() {
  const timespec period{0, Scanner::kPeriodNs};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &period, nullptr);
}

bool receives(const Registers& registers) {
  return registers.all_set(0, csr0::kReceive | csr0::kMemoryInterrupts);
}

bool sends_interrupt(CardSession::CardView card, std::uint32_t longword) {
  const Registers registers{*card.card};
  return registers.all_set(0, csr0::kTransmit | csr0::kSendInterrupts) &&
         (registers.all_set(0, csr0::kAllSendInterrupts) ||
          (card.acr[longword].load() & acr::kTransmitInterrupt) != 0);
}

}  // namespace

// The right to compare: among the threads of this process, then among the processes of this card.
// Signals are blocked while it lasts, so that a handler never waits for the thread it interrupted.
class Scanner::Turn {
 public:
  explicit Turn(Scanner& scanner) : claim_{&scanner.session_->card().plus.scanner} {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
    lock_ = std::unique_lock{scanner.mutex_};
    const broker::Claim self = scanner.session_->self();
    broker::Claim holder = claim_->load();
    if (holder != 0 && holder != self && broker::is_alive(holder)) return;
    mine_ = claim_->compare_exchange_strong(holder, self);
  }
  ~Turn() {
    if (mine_) claim_->store(0);
    lock_.unlock();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  Turn(const Turn&) = delete;
  Turn& operator=(const Turn&) = delete;
  [[nodiscard]] bool is_mine() const { return mine_; }

 private:
  SharedClaim* claim_;
  sigset_t before_{};
  std::unique_lock<std::mutex> lock_;
  bool mine_ = false;
};

bool Scanner::is_enabled() const { return receives(Registers{session_->card()}); }

void Scanner::look() {
  if (is_enabled()) {
    const Turn turn{*this};
    if (turn.is_mine()) compare();
  }
  deliver_if_due(session_->card());
}

void Scanner::compare() {
  rebuild_if_changed();
  const auto& own = session_->own();
  const auto look_at = [&](std::uint32_t longword) {
    const std::uint32_t word = words_[longword].load(std::memory_order_acquire);
    if (word == own.known[longword].load(std::memory_order_relaxed)) return;
    own.known[longword].store(word, std::memory_order_relaxed);
    if (!somebody_interrupts(longword)) return;
    if (!push(own.card->plus.fifo, (network_longword_ + longword) * 4))
      Registers{*own.card}.latch(csr1::kInterruptFifoFull);
  };
  if (watches_all_)
    for (std::uint32_t longword = 0; longword < longwords_; ++longword) look_at(longword);
  else
    for (const std::uint32_t longword : watched_) look_at(longword);
}

// Which card wrote a word cannot be seen. It is counted as foreign if another card sends
// interrupts there, and as our own if only we do.
bool Scanner::somebody_interrupts(std::uint32_t longword) const {
  const auto& own = session_->own();
  const Registers registers{*own.card};
  const std::uint32_t network = network_longword_ + longword;
  bool found = registers.all_set(8, csr8::kAllInterrupt) ||
               (registers.all_set(2, csr2::kReceiveOwn | csr2::kInterruptOwn) &&
                sends_interrupt(own, longword));
  session_->for_each_card([&](const CardSession::CardView& card) {
    if (card.card != own.card && network < session_->memory_bytes() / 4)
      found |= sends_interrupt(card, network);
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

// Without room for its last value a word cannot be watched, and the ACR says so.
void Scanner::remember(std::uint32_t longword) {
  const auto& own = session_->own();
  if (session_->take_known(longword, 1))
    own.known[longword].store(words_[longword].load());
  else
    own.acr[longword].fetch_and(~acr::kReceiveInterrupt);
}

void Scanner::start_afresh() {
  const Turn turn{*this};
  if (!turn.is_mine()) return;
  has_list_ = false;
  rebuild_if_changed();
  for (const std::uint32_t longword : watched_) remember(longword);
  if (!watches_all_ || !session_->take_known(0, longwords_)) return;
  for (std::uint32_t i = 0; i < longwords_; ++i) session_->own().known[i].store(words_[i].load());
}

void Scanner::start_afresh(std::uint32_t longword) {
  const Turn turn{*this};
  if (turn.is_mine()) remember(longword);
}

void Scanner::set_window(const Word* words, std::uint32_t longwords, std::uint32_t network) {
  const Turn turn{*this};
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
  pthread_sigmask(SIG_SETMASK, &all, &before);  // which the thread inherits: it handles none
  thread_ = std::thread{[this] {
    prctl(PR_SET_TIMERSLACK, 1000UL);
    while (!stop_.load()) {
      look();
      sleep_for_a_period();
    }
  }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace rths::scramnet
