// SPDX-License-Identifier: Apache-2.0
#include <rths/core/interrupted.hpp>

#include <atomic>
#include <cstddef>
#include <iterator>

namespace rths {
namespace {

std::atomic<bool> is_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler stores it");

extern "C" void note_signal(int signal) {
  if (is_interrupted.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // ends the process when this handler returns
  }
}

}  // namespace

Interruptible::Interruptible() {
  is_interrupted = false;
  struct sigaction action {};
  action.sa_handler = note_signal;
  for (std::size_t i = 0; i < std::size(kEndingSignals); ++i) {
    sigaction(kEndingSignals[i], nullptr, &previous_[i]);
    if (previous_[i].sa_handler != SIG_IGN) sigaction(kEndingSignals[i], &action, nullptr);
  }
}

Interruptible::~Interruptible() {
  for (std::size_t i = 0; i < std::size(kEndingSignals); ++i)
    sigaction(kEndingSignals[i], &previous_[i], nullptr);
  is_interrupted = false;
}

void stop_if_interrupted() {
  if (is_interrupted.load(std::memory_order_relaxed)) throw Interrupted{};
}

}  // namespace rths
