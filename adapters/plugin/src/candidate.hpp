// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <rths/plugin/conformance.hpp>
#include <rths/plugin/library.hpp>

#include "calls.hpp"

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

inline constexpr int kTrialSteps = 400;  ///< of a run

/// Ends a trial whose further rules need what failed.
struct Ended {};

/// Durations of the steps since activation [s].
struct StepDurations {
  std::vector<double> wall, processor;
};

/// A plugin under trial. Each call is noted in the report, so that a crash can be named; each step
/// is judged.
class PluginUnderTest {
 public:
  /// All of them must outlive it.
  PluginUnderTest(const Library& library, const ConformanceSettings& settings, TrialReport& report)
      : library_{library}, adapter_{library.adapter()}, settings_{settings}, report_{report} {}

  /// Each of these @throws Ended if the plugin cannot continue.
  void create();
  void read_signals();
  void activate();
  rths_status step();
  void stop();
  void deactivate();
  void destroy();

  [[nodiscard]] const std::vector<rths_signal>& signals() const { return signals_; }
  [[nodiscard]] double* out();
  [[nodiscard]] std::size_t outputs() const { return outputs_; }
  [[nodiscard]] const StepDurations& times() const { return times_; }

 private:
  void call(const std::string& name);
  [[nodiscard]] double input(const rths_signal& signal, std::size_t index, double time) const;
  void check_heap(long calls);
  void check_outputs();
  void check_status(rths_status status);

  const Library& library_;
  const rths_adapter& adapter_;
  const ConformanceSettings& settings_;
  TrialReport& report_;
  void* self_ = nullptr;
  std::vector<rths_signal> signals_;
  std::size_t outputs_ = 0;
  std::vector<double> in_, out_;
  StepDurations times_;
  int steps_ = 0;
};

}  // namespace rths::plugin
