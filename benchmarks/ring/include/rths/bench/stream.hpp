// SPDX-License-Identifier: Apache-2.0
//
// Throughput in one direction: one process sends without pause, the other receives every message.
// Ends:
//
//     struct End {
//       bool offer(std::uint32_t number);  // sends; false if the receiver is too far behind
//       bool take(std::uint32_t& number);  // receives; false if there is no message
//     };
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <rths/bench/round_trip.hpp>

namespace rths::bench {

inline constexpr std::uint32_t kStreamRun = 1U << 17U;  ///< messages of one time

/// Receives every message of a stream and reports the end of each run.
/// @throws Error if a message is lost
template <class End>
void take_stream(End& end, std::uint32_t runs, std::atomic<std::uint32_t>& received) {
  SpinLimit limit;
  for (std::uint32_t n = 0; n < runs * kStreamRun; ++n) {
    std::uint32_t number = 0;
    while (!end.take(number)) limit.count();
    limit.reset();
    if (number != n) throw Error{"a message was lost"};
    if ((n + 1) % kStreamRun == 0) received.store(n + 1, std::memory_order_release);
  }
}

/// Times a stream.
/// @param make_end  creates the end of a side, in that side's process
/// @returns time of a message, over runs of messages
/// @throws Error if a message is lost
template <class MakeEnd>
[[nodiscard]] Times stream_times(const Setup& setup, MakeEnd make_end) {
  const std::uint32_t runs = std::max(1U, setup.round_trips / 5'000);
  const Shared<std::atomic<std::uint32_t>> ready;
  const Shared<std::atomic<std::uint32_t>> received;
  Partner far{setup.cpus.far, [&] {
                auto end = make_end(Side::Far);
                ready->store(1, std::memory_order_release);
                take_stream(end, runs, *received);
              }};
  const Pinned pinned{setup.cpus.near};
  auto end = make_end(Side::Near);
  await_ready(*ready, far);
  SpinLimit limit{&far};
  std::vector<double> costs;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const std::uint64_t begun = stamp();
    for (std::uint32_t n = run * kStreamRun; n < (run + 1) * kStreamRun; ++n) {
      while (!end.offer(n)) limit.count();
      limit.reset();
    }
    while (received->load(std::memory_order_acquire) != (run + 1) * kStreamRun) limit.count();
    costs.push_back(static_cast<double>(stamp() - begun) * setup.tick / kStreamRun);
  }
  far.join();
  return times_of(std::move(costs));
}

}  // namespace rths::bench
