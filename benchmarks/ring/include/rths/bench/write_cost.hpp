// SPDX-License-Identifier: Apache-2.0
//
// Time of a write in the writer, without readers or while the other processor reads continuously.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <rths/bench/round_trip.hpp>

namespace rths::bench {

/// Times `write(i)`, i = 0, 1, …, in runs that are long compared with reading the clock.
/// @returns time of one write
template <class Write>
[[nodiscard]] Times write_times(const Setup& setup, Write write) {
  constexpr std::uint32_t kRun = 1024;
  const Pinned pinned{setup.cpus.near};
  std::vector<double> costs;
  for (std::uint32_t done = 0; done < setup.round_trips + kRun; done += kRun) {
    const std::uint64_t begun = stamp();
    for (std::uint32_t i = 0; i < kRun; ++i) write(done + i);
    costs.push_back(static_cast<double>(stamp() - begun) * setup.tick / kRun);
  }
  return times_of(std::move(costs));
}

/// Times the writes of a record that the other processor reads without pause: each from its first
/// to its last instruction, less the time to read the clock. Draining the store buffer afterwards
/// does not block the writer and is not included.
/// @param gap       between two writes [ns]
/// @param make_end  creates an end with `fill(number)`, `write()`, `read()`, in its side's process
template <class MakeEnd>
[[nodiscard]] Times write_times_under_reader(const Setup& setup, std::uint32_t gap,
                                             MakeEnd make_end) {
  const Shared<std::atomic<std::uint32_t>> ready;
  const Shared<std::atomic<std::uint32_t>> over;
  Partner reader{setup.cpus.far, [&] {
                   auto end = make_end(Side::Far);
                   ready->store(1, std::memory_order_release);
                   while (over->load(std::memory_order_relaxed) == 0) end.read();
                 }};
  const Pinned pinned{setup.cpus.near};
  auto end = make_end(Side::Near);
  await_ready(*ready, reader);
  std::vector<double> costs;
  const auto gap_ticks = static_cast<std::uint64_t>(gap / setup.tick);
  for (std::uint32_t number = 1; number <= setup.round_trips; ++number) {
    for (const std::uint64_t begun = stamp(); stamp() - begun < gap_ticks;) {
    }
    end.fill(number);
    const std::uint64_t before = stamp_between();
    const std::uint64_t begun = stamp_between();
    end.write();
    const std::uint64_t after = stamp_between();
    const auto ticks = static_cast<double>(after - begun) - static_cast<double>(begun - before);
    costs.push_back(std::max(1.0, ticks) * setup.tick);
  }
  over->store(1, std::memory_order_relaxed);
  reader.join();
  return times_of(std::move(costs));
}

}  // namespace rths::bench
