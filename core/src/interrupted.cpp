// SPDX-License-Identifier: Apache-2.0
#include <rths/core/interrupted.hpp>

#include <atomic>
#include <cstddef>

namespace rths {
namespace {

std::atomic<bool> is_noted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler stores it");

extern "C" void note_signal(int signal) {
  if (is_noted.exchange(true)) {
    std::signal(signal, SIG_DFL);
    std::raise(signal);  // ends the process when this handler returns
  }
}

}  // namespace

Interruptible::Interruptible() {
  is_noted = false;
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
  is_noted = false;
}

bool is_interrupted() noexcept { return is_noted.load(std::memory_order_relaxed); }

void stop_if_interrupted() {
  if (is_interrupted()) throw Interrupted{};
}

}  // namespace rths
