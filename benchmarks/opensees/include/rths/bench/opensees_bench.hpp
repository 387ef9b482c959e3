// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

struct OpenSeesOptions {
  int cycles = 9;
  int round_trips = 2'000;         ///< of each kind in each cycle
  std::filesystem::path programs;  ///< folder of `rths`
};

/// Round trips over one kind of socket: medians over cycles.
struct TripResult {
  std::string protocol;  ///< "tcp" or "udp"
  Times through_ring;    ///< from an element's trial to its force, through ring and specimen
  Times bare;            ///< a message and an answer of the same sizes
  double ratio_p50 = 0;  ///< median over cycles [-]
  Interval ratio_interval;
  double ratio_p99 = 0;
  GateResult gate_result = GateResult::NotJudged;
};

struct OpenSeesReport {
  Machine machine;
  int cycles = 0, round_trips = 0;
  std::vector<TripResult> trips;
  double steal = 0;  ///< share of the two processors' time that the host used [-]
  std::vector<std::string> troubles;
  GateResult result = GateResult::Inconclusive;
};

/// Gate: upper bound of the median ratio to the bare ping-pong [-].
inline constexpr double kMostOfBare = 3;

/// Measures both protocols. @throws Error if the run at the other end does not start or answer
/// @setup
[[nodiscard]] OpenSeesReport run_opensees_bench(const OpenSeesOptions& options);

/// The report as one JSON document, or as lines of text.
[[nodiscard]] std::string to_json(const OpenSeesReport& report);
[[nodiscard]] std::string to_text(const OpenSeesReport& report);

}  // namespace rths::bench
