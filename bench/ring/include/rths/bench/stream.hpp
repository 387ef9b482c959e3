// SPDX-License-Identifier: Apache-2.0
//
// How many messages a second go one way, from a process that sends without rest to one that takes
// them all. Its ends:
//
//     struct End {
//       bool offer(std::uint32_t number);  // sends, or says that there is no room for more
//       bool take(std::uint32_t& number);  // the next message, if there is one
//     };
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <rths/bench/round_trip.hpp>

namespace rths::bench {

/// Times a stream.
/// @param make_end  makes the end of a side, in that side's process
/// @returns time of a message, over runs of messages of which none is lost
/// @throws Error if one is
template <class MakeEnd>
[[nodiscard]] Times stream_times(const Setup& setup, MakeEnd make_end) {
  constexpr std::uint32_t kRun = 1U << 17U;
  const std::uint32_t runs = std::max(1U, setup.round_trips / 5'000);
  const Shared<std::atomic<std::uint32_t>> ready;
  const Shared<std::atomic<std::uint32_t>> received;
  Partner far{setup.cpus.far, [&] {
                auto end = make_end(Side::Far);
                Patience patience;
                ready->store(1, std::memory_order_release);
                for (std::uint32_t n = 0; n < runs * kRun; ++n) {
                  std::uint32_t number = 0;
                  while (!end.take(number)) patience.spend();
                  patience.restore();
                  if (number != n) throw Error{"a message was lost"};
                  if ((n + 1) % kRun == 0) received->store(n + 1, std::memory_order_release);
                }
              }};
  const Pinned pinned{setup.cpus.near};
  auto end = make_end(Side::Near);
  await_ready(*ready, far);
  Patience patience{&far};
  std::vector<double> costs;
  for (std::uint32_t run = 0; run < runs; ++run) {
    const std::uint64_t begun = stamp();
    for (std::uint32_t n = run * kRun; n < (run + 1) * kRun; ++n) {
      while (!end.offer(n)) patience.spend();
      patience.restore();
    }
    while (received->load(std::memory_order_acquire) != (run + 1) * kRun) patience.spend();
    costs.push_back(static_cast<double>(stamp() - begun) * setup.tick / kRun);
  }
  far.join();
  return times_of(std::move(costs));
}

}  // namespace rths::bench
