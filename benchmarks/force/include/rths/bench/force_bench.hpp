// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <rths/bench/result.hpp>
#include <rths/controller/table_force.hpp>

namespace rths::bench {

struct ForceOptions {
  int seeds = 100;
  double duration = 40;  ///< of a run [s]
  std::function<void(const std::string& stage)> progress;
};

/// How often the interval of a parameter covers its true value.
struct ForceParameter {
  std::string name;
  int covered = 0;
  double largest_error = 0;  ///< of all seeds, relative to the true value [-]
};

/// Residual of the observer on a run that the identification has not seen, per seed [N].
struct ForceResiduals {
  std::vector<double> rms, peak;
};

struct ForceReport {
  int seeds = 0;
  double duration = 0;
  double largest_acceleration = 0;  ///< of the runs [m/s²]
  double cutoff = 0;                ///< of the observer [Hz]
  double largest_lag = 0;           ///< of the observer's result [s]
  std::vector<ForceParameter> parameters;
  ForceResiduals ours;   ///< with load-dependent and presliding friction, accelerometer delay
  ForceResiduals paper;  ///< equation 1 of the paper, behind the same low-pass
  GateResult result = GateResult::Fail;
};

/// Goals for every seed [N], and for each parameter.
inline constexpr double kForceRmsGoal = 5e3, kForcePeakGoal = 15e3;
inline constexpr double kCoverageGoal = 0.9;

/// Identifies machines of random parameters from a harmonic and an earthquake run with an empty
/// table, up to 1.8 g, and corrects another earthquake run. The machines are this bench's own
/// equations.
/// @throws Error if there is no seed   @setup
[[nodiscard]] ForceReport run_force_bench(const ForceOptions& options);

[[nodiscard]] std::string to_json(const ForceReport& report);
[[nodiscard]] std::string to_text(const ForceReport& report);

}  // namespace rths::bench
