// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/bench/judge.hpp>
#include <rths/bench/machine.hpp>
#include <rths/bench/opensees.hpp>
#include <rths/bench/step_times.hpp>

namespace rths::bench {

struct BearingOptions {
  int passes = 9;      ///< over the same motion
  int steps = 30'000;  ///< of a pass, at 1 kHz
  int opensees_steps = 4'000;
  std::filesystem::path bearings;                         ///< folder of the compositions
  std::filesystem::path script;                           ///< that moves OpenSees' elements
  std::string python;                                     ///< that has OpenSees; empty: none
  std::function<void(const std::string& what)> progress;  ///< told what is measured next
};

/// What was found of one bearing.
struct BearingResult {
  std::string name, title;
  std::vector<std::string> terms;  ///< of the composition
  StepTimes earthquake;            ///< a step of a violent motion in both directions
  StepTimes adversarial;           ///< a step of jumps, stops and uplift
  double dual_ratio = 0;           ///< a step with four derivatives over one without [-]
  double in_loop = 0;              ///< a step of one of 486 bearings, one after the other [ns]
  double goal = 0;                 ///< on the middle of `earthquake` [ns]; 0: none
  GateResult verdict = GateResult::NotJudged;
  OpenseesTimes opensees;
};

struct BearingReport {
  Machine machine;
  int passes = 0, steps = 0;
  std::vector<BearingResult> bearings;
  std::vector<std::string> troubles;  ///< why a goal that is missed says nothing
  GateResult result = GateResult::Inconclusive;
};

/// Measures the compositions on one processor. A goal that is met stands whoever else was at work
/// meanwhile: others only make it slower. One that is missed then is inconclusive.
/// @throws Error if a composition cannot be read   @setup
[[nodiscard]] BearingReport run_bearing_bench(const BearingOptions& options);

/// The report as one JSON document, or as tables for people.
[[nodiscard]] std::string to_json(const BearingReport& report);
[[nodiscard]] std::string to_text(const BearingReport& report);

}  // namespace rths::bench
