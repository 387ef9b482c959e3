// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <rths/plugin/conformance.hpp>
#include <rths/plugin/library.hpp>

#include "calls.hpp"
#include "trial.hpp"

namespace rths::plugin {

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
