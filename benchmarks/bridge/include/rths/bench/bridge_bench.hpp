// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

struct BridgeOptions {
  int cycles = 5;
  std::uint32_t updates = 2'000'000;  ///< of each cycle
  std::uint32_t samples = 100'000;    ///< bare samples of each cycle, one word each
  int round_trips = 2'000;            ///< of each kind in each cycle
  std::uint32_t domain = 211;         ///< of the bare samples; the gateways use the next one
};

/// Bounds: what is aimed at, and what fails [-].
inline constexpr double kUpdatesGoal = 100, kUpdatesGate = 40;
inline constexpr double kLatencyGoal = 1.15, kLatencyGate = 1.4;
inline constexpr double kResyncGoal = 2;

struct BridgeReport {
  Machine machine;
  int cycles = 0;
  double updates_per_s = 0, samples_per_s = 0;  ///< medians over cycles
  double updates_ratio = 0;
  double updates_per_frame = 0;           ///< of the last cycle
  std::uint64_t lost = 0, reordered = 0;  ///< updates of all cycles
  Times latency, bare_latency;            ///< one way, medians over cycles
  double latency_ratio_p50 = 0;
  Interval latency_ratio_interval;
  double resync_s = 0, bare_bytes_per_s = 0;
  double resync_ratio = 0;               ///< to 8 MiB at the rate of bare samples
  double near_share = 0, far_share = 0;  ///< of one processor, at 1 kHz and 100 words
  double steal = 0;                      ///< share of two processors that the host used [-]
  std::vector<std::string> troubles;
  GateResult result = GateResult::Inconclusive;
};

/// Measures with a second process. Call it before the program has other threads.
/// @throws Error if DDS cannot start or the second process does not answer   @setup
[[nodiscard]] BridgeReport run_bridge_bench(const BridgeOptions& options);

/// The report as one JSON document, or as lines of text.
[[nodiscard]] std::string to_json(const BridgeReport& report);
[[nodiscard]] std::string to_text(const BridgeReport& report);

}  // namespace rths::bench
