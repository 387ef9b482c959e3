// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>

namespace rths::plugin {

/// Rules in the order of their report.
enum Rule : std::size_t {
  kExports,
  kAbi,
  kLifecycle,
  kSignals,
  kUnits,
  kRange,
  kNan,
  kBounds,
  kDeadline,
  kAllocation,
  kStop,
  kRestart,
  kInstances,
  kDeterminism,
  kCrash,
  kRules
};

/// Results of a trial, in memory that parent and child share.
struct TrialReport {
  struct Rule {
    bool tried = false, failed = false;
    std::array<char, 500> text{};
  };
  std::array<Rule, kRules> rules;
  std::array<char, 100> call{};   ///< that the child makes now
  std::uint64_t fingerprint = 0;  ///< of all outputs
  bool completed = false;

  void pass(std::size_t rule, const std::string& text = "");
  /// The first failure of a rule is kept.
  void fail(std::size_t rule, const std::string& text);
  [[nodiscard]] bool has_failed() const;
};

/// Runs a trial in a child process and returns its report. A crash fails kCrash, also one of a
/// destructor at the end of the process; a call that does not return fails kDeadline.   @setup
[[nodiscard]] TrialReport run_trial(const std::function<void(TrialReport&)>& trial,
                                    double deadline);

}  // namespace rths::plugin
