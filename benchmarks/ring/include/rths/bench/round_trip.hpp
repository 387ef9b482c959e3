// SPDX-License-Identifier: Apache-2.0
//
// Times round trips: two processes on two processors pass a number back and forth. Each process
// passes it through an end:
//
//     struct End {
//       void send(std::uint32_t number);      // sends it to the other side
//       bool arrived(std::uint32_t number);   // polls once whether it has arrived from there
//     };
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <utility>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/partner.hpp>
#include <rths/bench/stamp.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

/// One of the two processes.
enum class Side { Near, Far };

[[nodiscard]] constexpr Side other(Side side) {
  return side == Side::Near ? Side::Far : Side::Near;
}

/// How a side polls: at once again, or after a pause instruction.
enum class Poll { Tight, Paused };

/// Processors and length of a measurement.
struct Setup {
  Cpus cpus;
  std::uint32_t round_trips = 0;
  double tick = 1;  ///< of `stamp` [ns]
};

template <Poll poll, class End>
void await(End& end, std::uint32_t number, SpinLimit& limit) {
  while (!end.arrived(number)) {
    if constexpr (poll == Poll::Paused) pause();
    limit.count();
  }
  limit.reset();
}

/// Sleeps until the other side has set `ready`.
inline void await_ready(const std::atomic<std::uint32_t>& ready, Partner& partner) {
  while (ready.load(std::memory_order_acquire) == 0) {
    partner.expect_alive();
    std::this_thread::sleep_for(std::chrono::microseconds{100});
  }
}

/// One-way times, half of the round trips. Leaves out the first tenth, which warms up caches and
/// predictors.
[[nodiscard]] inline Times one_way(const std::vector<std::uint64_t>& trips, double tick) {
  std::vector<double> nanoseconds;
  nanoseconds.reserve(trips.size());
  for (std::size_t i = trips.size() / 10; i < trips.size(); ++i)
    nanoseconds.push_back(static_cast<double>(trips[i]) * tick / 2);
  return times_of(std::move(nanoseconds));
}

/// Times round trips.
/// @param make_end  creates the end of a side, in that side's process
template <Poll poll = Poll::Tight, class MakeEnd>
[[nodiscard]] Times round_trips(const Setup& setup, MakeEnd make_end) {
  const Shared<std::atomic<std::uint32_t>> ready;
  Partner far{setup.cpus.far, [&] {
                auto end = make_end(Side::Far);
                SpinLimit limit;
                ready->store(1, std::memory_order_release);
                for (std::uint32_t n = 1; n <= setup.round_trips; ++n) {
                  await<poll>(end, n, limit);
                  end.send(n);
                }
              }};
  const Pinned pinned{setup.cpus.near};
  auto end = make_end(Side::Near);
  await_ready(*ready, far);
  SpinLimit limit{&far};
  std::vector<std::uint64_t> trips(setup.round_trips, 0);
  std::uint64_t before = stamp();
  for (std::uint32_t n = 1; n <= setup.round_trips; ++n) {
    end.send(n);
    await<poll>(end, n, limit);
    const std::uint64_t now = stamp();
    trips[n - 1] = now - before;
    before = now;
  }
  far.join();
  return one_way(trips, setup.tick);
}

/// The physical limit: two words, each alone on its cache line.
struct RawLines {
  alignas(128) std::atomic<std::uint32_t> there{0};
  alignas(128) std::atomic<std::uint32_t> back{0};

  /// The word that a side writes, and the word that it reads.
  [[nodiscard]] std::atomic<std::uint32_t>& out(Side side) {
    return side == Side::Near ? there : back;
  }
  [[nodiscard]] std::atomic<std::uint32_t>& in(Side side) { return out(other(side)); }
};

/// A word stored through a plain pointer, as in programs for the cards.
class RawEnd {
 public:
  RawEnd(RawLines& lines, Side side) : out_{lines.out(side)}, in_{lines.in(side)} {}
  void send(std::uint32_t number) { out_.store(number, std::memory_order_release); }
  [[nodiscard]] bool arrived(std::uint32_t number) const {
    return in_.load(std::memory_order_acquire) == number;
  }

 private:
  std::atomic<std::uint32_t>& out_;
  std::atomic<std::uint32_t>& in_;
};

template <Poll poll = Poll::Tight>
[[nodiscard]] Times raw_round_trips(const Setup& setup) {
  const Shared<RawLines> lines;
  return round_trips<poll>(setup, [&](Side side) { return RawEnd{*lines, side}; });
}

}  // namespace rths::bench
