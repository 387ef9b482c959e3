// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <rths/report/comparison.hpp>
#include <rths/session/progress.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::session {

/// Why one recording differs from another.
struct Difference {
  std::string sentence;  ///< the answer
  /// Of signals: unit, sign, scale, offset, delay. If the force does not differ, also changed delay
  /// and gain of the machine behind its reference.
  std::vector<std::string> mistakes;
  /// Of the other, with the simulation of the baseline as the model; none: no model was needed.
  std::optional<diagnosis::Verdict> verdict;
  std::string model;  ///< of the verdict: whose simulation it is; empty: none
  /// The verdict is that of the baseline, with the simulation of the other: the other lacks its
  /// terms.
  bool is_reversed = false;
};

/// Explains the difference of two compared runs. If the resemblance of signals leaves none that
/// differs, it is the answer. Otherwise the recording of the other is diagnosed: its model is the
/// laboratory of the baseline if that is simulated and its experiment's file is as it was, else the
/// simulation that the baseline's experiment states. Without a model, the signals of the baseline
/// are the simulation of those of the other.
/// @param seed  of noise and resampling
/// @throws Error if a recording cannot be diagnosed; Interrupted   @setup
[[nodiscard]] Difference why(const report::ComparedRuns& comparison, std::uint64_t seed = 1,
                             const Progress& progress = {});

/// As lines for a terminal, and as an object of JSON.
[[nodiscard]] std::string text_of(const Difference& difference);
[[nodiscard]] std::string json_of(const Difference& difference);

}  // namespace rths::session
