// SPDX-License-Identifier: Apache-2.0
//
// What a write costs the one who writes, alone or while the other processor reads all the time.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <vector>

#include <rths/bench/round_trip.hpp>

namespace rths::bench {

/// Times `write(i)`, i = 0, 1, …, in runs of so many that the clock does not show.
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

/// What a writer does between two writes: about a microsecond of multiplications that wait for each
/// other. A write hides behind them exactly as it hides behind a program's own work.
inline void work_between_writes() {
  constexpr int kMultiplications = 800;
  std::uint64_t product = 3;
  for (int i = 0; i < kMultiplications; ++i) {
    product *= 0x9E3779B97F4A7C15U;
    asm volatile("" : "+r"(product));
  }
}

/// Time of one of a run of writes, each with work before it.
/// @param write  called with the number of the write
template <class Write>
[[nodiscard]] double run_time(std::uint32_t first, std::uint32_t writes, Write write) {
  const std::uint64_t begun = stamp();
  for (std::uint32_t i = 0; i < writes; ++i) {
    work_between_writes();
    write(first + i);
  }
  return static_cast<double>(stamp() - begun) / writes;
}

/// Times the writes of a record that the other processor reads without pause. The work between
/// them is timed right before, without writes, and taken off.
/// @param make_end  makes an end with `write(number)` and `read()`, in its side's process
template <class MakeEnd>
[[nodiscard]] Times write_times_under_reader(const Setup& setup, MakeEnd make_end) {
  constexpr std::uint32_t kRun = 64;
  constexpr double kResolution = 0.1;  // of a difference of two times of a microsecond [ns]
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
  for (std::uint32_t done = 0; done < setup.round_trips; done += kRun) {
    const double work = run_time(done, kRun, [](std::uint32_t) {});
    const double both = run_time(done, kRun, [&](std::uint32_t number) { end.write(number); });
    costs.push_back(std::max(kResolution, (both - work) * setup.tick));
  }
  over->store(1, std::memory_order_relaxed);
  reader.join();
  return times_of(std::move(costs));
}

}  // namespace rths::bench
