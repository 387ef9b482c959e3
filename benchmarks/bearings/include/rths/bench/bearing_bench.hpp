// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/opensees.hpp>
#include <rths/bench/result.hpp>
#include <rths/bench/step_times.hpp>

namespace rths::bench {

struct BearingOptions {
  int passes = 9;      ///< number of runs of the same motion
  int steps = 30'000;  ///< of a pass, at 1 kHz
  int opensees_steps = 4'000;
  std::filesystem::path bearings;                          ///< folder of the compositions
  std::filesystem::path script;                            ///< moves OpenSees' elements
  std::string python;                                      ///< a Python with OpenSees; empty: none
  std::function<void(const std::string& stage)> progress;  ///< called before each stage
};

/// Results of one bearing.
struct BearingResult {
  std::string name, title;
  std::vector<std::string> terms;  ///< of the composition
  StepTimes earthquake;            ///< a step of a strong motion in both directions
  StepTimes adversarial;           ///< a step of the worst case: jumps, stops, uplift
  double dual_ratio = 0;           ///< time of a step with four derivatives / without [-]
  double in_loop = 0;              ///< a step of one of 486 bearings in a loop [ns]
  double goal = 0;                 ///< for the median of `earthquake` [ns]; 0: none
  GateResult gate_result = GateResult::NotJudged;
  OpenSeesTimes opensees;
};

struct BearingReport {
  Machine machine;
  int passes = 0, steps = 0;
  std::vector<BearingResult> bearings;
  std::vector<std::string> troubles;  ///< reasons why a missed goal is inconclusive
  GateResult result = GateResult::Inconclusive;
};

/// Measures the compositions on one processor. Other processes can only slow a step down, so a goal
/// that is met passes also on a busy machine; a goal that is missed there is inconclusive.
/// @throws Error if a composition cannot be read   @setup
[[nodiscard]] BearingReport run_bearing_bench(const BearingOptions& options);

/// The report as one JSON document, or as tables of text.
[[nodiscard]] std::string to_json(const BearingReport& report);
[[nodiscard]] std::string to_text(const BearingReport& report);

}  // namespace rths::bench
