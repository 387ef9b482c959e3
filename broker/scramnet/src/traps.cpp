// SPDX-License-Identifier: Apache-2.0
#include "traps.hpp"

#include <algorithm>
#include <csignal>

#include <rths/card/bits.hpp>
#include <rths/card/registers.hpp>

#include "trapped_window.hpp"
#include "warning.hpp"

namespace rths::scramnet {
namespace {

#if defined(__x86_64__)
constexpr bool kHasTraps = true;
#else
constexpr bool kHasTraps = false;
#endif

constexpr std::uint64_t kWordsPerPage = kTrapPage / 4;

bool are_active(const CardSession& session, bool wanted) {
  const bool active = wanted && session.card().carried.active.load() != 0;
  if (active && !kHasTraps)
    warn_once("traps", "stores through a pointer are not trapped on this processor, but scanned");
  return active && kHasTraps;
}

/// Blocks signals while the lock is held, so that a handler never waits for the thread that it
/// interrupted.
class QuietLock {
 public:
  explicit QuietLock(std::mutex& mutex) {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before_);
    lock_ = std::unique_lock{mutex};
  }
  ~QuietLock() {
    lock_.unlock();
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  QuietLock(const QuietLock&) = delete;
  QuietLock& operator=(const QuietLock&) = delete;

 private:
  sigset_t before_{};
  std::unique_lock<std::mutex> lock_;
};

}  // namespace

Traps::Traps(const CardSession& session, bool wanted)
    : session_{&session}, active_{are_active(session, wanted)} {
  session.card().carried.has_traps.store(active_ ? 1 : 0);
  if (active_) trapped_window.card.store(&session.card());
}

void Traps::set_window(const Window& window) {
  if (!active_) return;
  const QuietLock lock{mutex_};
  for (auto& page : trapped_window.closed) page.store(false);
  for (auto& page : trapped_window.hidden) page.store(false);
  trapped_window.memory.store(window.memory);
  trapped_window.offset.store(window.offset);
  trapped_window.bytes.store(window.bytes);
  trapped_window.shows_acr.store(window.shows_acr);
  trapped_window.window.store(window.window);
  changed_ = true;
}

bool Traps::all_wanted() const {
  const Registers registers{session_->card()};
  return registers.all_set(2, csr2::kNoHostWrite) ||
         registers.all_set(0, csr0::kSendInterrupts | csr0::kAllSendInterrupts);
}

// A scan cannot tell who has stored a word of another node, so it takes only own ones.
bool Traps::is_wanted(std::uint64_t page) const {
  if (!session_->owns(trapped_window.offset / 4 + page * kWordsPerPage, kWordsPerPage)) return true;
  constexpr std::uint32_t kNeedsTrap =
      acr::kTransmitInterrupt | acr::kTriggerOnHostWrite | acr::kHiPro;
  const Word* const words = session_->own().acr + page * kWordsPerPage;
  return std::any_of(words, words + kWordsPerPage, [](const Word& word) {
    return (word.load(std::memory_order_relaxed) & kNeedsTrap) != 0;
  });
}

bool Traps::is_due() const {
  return active_ && (changed_ || all_ != all_wanted() ||
                     acr_changes_ != session_->card().plus.acr_changes.load());
}

bool Traps::opens_a_page() const {
  if (!active_ || all_wanted()) return false;
  for (std::uint64_t page = 0; page < trapped_window.bytes.load() / kTrapPage; ++page)
    if (trapped_window.closed[page].load() && !is_wanted(page)) return true;
  return false;
}

void Traps::update(std::uint64_t page) {
  const bool close = all_ || is_wanted(page);
  if (close) handle_traps();
  if (trapped_window.closed[page].exchange(close) == close) return;
  if (close)
    trapped_window.close_page(page * kTrapPage);
  else
    trapped_window.open_page(page * kTrapPage);
}

void Traps::follow() {
  if (!is_due()) return;
  const QuietLock lock{mutex_};
  acr_changes_ = session_->card().plus.acr_changes.load();
  all_ = all_wanted();
  changed_ = false;
  if (trapped_window.window.load() == nullptr || trapped_window.shows_acr) return;
  const std::uint64_t pages = trapped_window.bytes.load() / kTrapPage;
  for (std::uint64_t page = 0; page < pages; ++page) update(page);
}

void Traps::follow_word(std::uint64_t offset) {
  const std::uint32_t changes = session_->card().plus.acr_changes.load();
  if (changed_ || all_ != all_wanted() || changes != acr_changes_ + 1) return follow();
  const QuietLock lock{mutex_};
  acr_changes_ = changes;
  if (trapped_window.window.load() != nullptr && !trapped_window.shows_acr)
    update(offset / kTrapPage);
}

bool Traps::is_closed(std::uint64_t offset) const {
  return active_ && trapped_window.closed[offset / kTrapPage].load();
}

void Traps::store(std::uint64_t offset, const std::byte* from, std::uint64_t bytes) {
  constexpr std::uint64_t kAtOnce = 64;
  const auto* const value = reinterpret_cast<const std::uint8_t*>(from);
  for (std::uint64_t i = 0; i < bytes; i += kAtOnce)
    trapped_window.store(offset + i, {value + i, std::min(kAtOnce, bytes - i)});
}

}  // namespace rths::scramnet
