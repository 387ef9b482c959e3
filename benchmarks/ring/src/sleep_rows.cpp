// SPDX-License-Identifier: Apache-2.0
//
// Wake-up times. Both sides sleep before each message.
#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <ctime>

#include "ring_end.hpp"
#include "ring_rows.hpp"

namespace rths::bench {
namespace {

constexpr double kWorkBeforeSending = 150'000;  // [ns]; longer than any side spins
constexpr std::uint32_t kMostSleeps = 1'000;    // a round trip takes as long as a thousand others

/// An end whose sides work before they send, so that the other side falls asleep.
template <class End>
class SleepyEnd {
 public:
  SleepyEnd(End end, double tick) : end_{std::move(end)}, tick_{tick} {}
  void send(std::uint32_t number) {
    const std::uint64_t begun = stamp();
    while (static_cast<double>(stamp() - begun) * tick_ < kWorkBeforeSending) pause();
    end_.send(number);
  }
  [[nodiscard]] bool arrived(std::uint32_t number) { return end_.arrived(number); }

 private:
  End end_;
  double tick_;
};

/// A bare futex word.
class FutexEnd {
 public:
  FutexEnd(RawLines& lines, Side side) : out_{lines.out(side)}, in_{lines.in(side)} {}
  void send(std::uint32_t number) {
    out_.store(number);
    futex(out_, FUTEX_WAKE, 1);
  }
  // Spins as long as a `Waiter`, so that the processor sleeps equally long in both.
  [[nodiscard]] bool arrived(std::uint32_t number) {
    const auto sleep_from = std::chrono::steady_clock::now() + std::chrono::microseconds{50};
    std::uint32_t found = in_.load();
    for (; found != number && std::chrono::steady_clock::now() < sleep_from; found = in_.load())
      pause();
    if (found == number) return true;
    futex(in_, FUTEX_WAIT, found);
    return in_.load() == number;
  }

 private:
  static void futex(std::atomic<std::uint32_t>& word, int operation, std::uint32_t value) {
    const timespec a_second{1, 0};
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
    syscall(SYS_futex, &word, operation, value, &a_second, nullptr, 0);
  }
  std::atomic<std::uint32_t>& out_;
  std::atomic<std::uint32_t>& in_;
};

/// One-way times from sending to receiving, without the work before sending.
template <class MakeEnd>
Times wake_times(const Workbench& bench, MakeEnd make_end) {
  Setup setup = bench.setup;
  setup.round_trips = std::min(setup.round_trips, kMostSleeps);
  const Times times = round_trips(setup, [&](Side side) {
    return SleepyEnd{make_end(side), setup.tick};
  });
  return {times.p50 - kWorkBeforeSending, times.p99 - kWorkBeforeSending};
}

}  // namespace

Pairing measure_wait_sleeping(const Row&, const Workbench& bench) {
  const Shared<RawLines> lines;
  const Times bare = wake_times(bench, [&](Side side) { return FutexEnd{*lines, side}; });
  const BenchRing ring{1, false};
  return {wake_times(bench, [&](Side side) { return WaitEnd{ring, side}; }), bare};
}

}  // namespace rths::bench
