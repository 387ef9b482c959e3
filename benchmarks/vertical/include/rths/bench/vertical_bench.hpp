// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <rths/bench/result.hpp>

namespace rths::bench {

struct VerticalOptions {
  int draws = 200;
  double duration = 30;  ///< of the command, in its own time [s]
  std::function<void(const std::string& stage)> progress;
};

/// Tracking of the force by one controller on one machine.
struct ForceTracking {
  double delay = 0;      ///< cross-correlation, in the command's time [s]
  double rms = 0;        ///< of the error / peak-to-peak of the command [-]
  double coherence = 0;  ///< smallest over 1 to 15 Hz of the command's time [-]
  bool stable = false;   ///< the error's RMS stays below half of the command's peak-to-peak
};

struct VerticalRow {
  std::string name, title;
  double rate = 1;                   ///< wall time over the command's time
  std::vector<ForceTracking> draws;  ///< the nominal machine first
};

struct VerticalReport {
  int draws = 0;
  double duration = 0;
  std::vector<VerticalRow> rows;  ///< cascade, cascade ten times slower, ours, ours without parts
  GateResult result = GateResult::Fail;
};

/// Goals for ours on every draw; the cascade must miss one at rate 1 and meet `rms` at rate 10.
inline constexpr double kVerticalDelayGoal = 2e-3, kVerticalRmsGoal = 0.02,
                        kVerticalCoherenceGoal = 0.95;

/// Benchmark VF-1: a bearing of 5 GN/m under 10 MN, a vertical force of ±5 MN with content to
/// 20 Hz, and a horizontal motion of 200 mm at 0.4 Hz that softens and shortens the bearing.
/// @throws Error if there is no draw   @setup
[[nodiscard]] VerticalReport run_vertical_bench(const VerticalOptions& options);

[[nodiscard]] std::string to_json(const VerticalReport& report);
[[nodiscard]] std::string to_text(const VerticalReport& report);

}  // namespace rths::bench
