// SPDX-License-Identifier: Apache-2.0
#include "interrupt.hpp"

namespace rths::launch {
namespace {

volatile std::sig_atomic_t interrupt_received = 0;  // NOLINT: for the signal handler
volatile std::sig_atomic_t stop_received = 0;       // NOLINT

extern "C" void note_interrupt(int signal) {
  (signal == kStopSignal ? stop_received : interrupt_received) = 1;
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupt_received = 0;
  stop_received = 0;
  struct sigaction action {};
  action.sa_handler = note_interrupt;
  for (std::size_t i = 0; i < kCount; ++i) sigaction(kSignals[i], &action, &previous_[i]);
}

InterruptGuard::~InterruptGuard() {
  for (std::size_t i = 0; i < kCount; ++i) sigaction(kSignals[i], &previous_[i], nullptr);
}

bool InterruptGuard::is_interrupted() { return interrupt_received != 0; }

bool InterruptGuard::is_stop_requested() { return stop_received != 0; }

bool InterruptGuard::is_called_off() { return is_interrupted() || is_stop_requested(); }

}  // namespace rths::launch
