// SPDX-License-Identifier: Apache-2.0
//
// What a write costs the one who writes, alone or while the other processor reads all the time.
#pragma once

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

/// What a writer does between two writes: about 200 ns of multiplications that wait for each
/// other. A write hides behind them exactly as it hides behind a program's own work.
inline void work_between_writes() {
  constexpr int kMultiplications = 160;
  std::uint64_t product = 3;
  for (int i = 0; i < kMultiplications; ++i) {
    product *= 0x9E3779B97F4A7C15U;
    asm volatile("" : "+r"(product));
  }
}

/// Times a run of writes with work between them; without a write, the work alone.
template <class Write>
[[nodiscard]] std::vector<double> run_times(const Setup& setup, Write write) {
  constexpr std::uint32_t kRun = 64;
  std::vector<double> costs;
  for (std::uint32_t done = 0; done < setup.round_trips + kRun; done += kRun) {
    const std::uint64_t begun = stamp();
    for (std::uint32_t i = 0; i < kRun; ++i) {
      work_between_writes();
      write(done + i);
    }
    costs.push_back(static_cast<double>(stamp() - begun) * setup.tick / kRun);
  }
  return costs;
}

/// Times the writes of a record that the other processor reads without pause.
/// @param make_end  makes an end with `write(number)` and `read()`, in its side's process
template <class MakeEnd>
[[nodiscard]] Times write_times_under_reader(const Setup& setup, MakeEnd make_end) {
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
  const double work = median(run_times(setup, [](std::uint32_t) {}));
  std::vector<double> costs = run_times(setup, [&](std::uint32_t number) { end.write(number); });
  over->store(1, std::memory_order_relaxed);
  reader.join();
  for (double& cost : costs) cost -= work;
  return times_of(std::move(costs));
}

}  // namespace rths::bench
