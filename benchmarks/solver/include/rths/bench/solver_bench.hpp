// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>

namespace rths::bench {

struct SolverOptions {
  std::vector<long> dofs{5'676, 47'952};  ///< nearest meshes of the plant
  int steps = 10'000;                     ///< of a row; of a full plant a tenth
  /// Of OpenSees, beyond that of its factorisation; of a plant above 15,000 a twentieth.
  int opensees_steps = 200;
  std::string python;            ///< a Python with OpenSees; empty: none
  std::filesystem::path script;  ///< solid_plant.py
  std::function<void(const std::string& stage)> progress;
};

/// Times of one step, in wall time, without those in which the host ran something else. OpenSees'
/// steps all count.
struct SolverRow {
  long dof = 0;
  std::size_t bearings = 0;
  double time_step = 0;                               ///< of the integration [s]
  std::string path;                                   ///< "reduced", "full" or "opensees"
  int coordinates = 0;                                ///< of a reduced plant
  double median = 0, p99 = 0, p999 = 0, largest = 0;  ///< of a whole step [s]
  double critical_median = 0, critical_p99 = 0;       ///< force known to next target [s]
  int steps = 0, excused = 0;
  int misses = 0;               ///< longer than 60 % of the time step
  double dofs_per_us = 0;       ///< over the median
  double memory = 0;            ///< of the process [B]
  double processor_median = 0;  ///< of OpenSees: processor time of a step [s]
  /// OpenSees' processor time of a step over our median; 0: not measured
  double ratio_to_opensees = 0;
};

struct SolverReport {
  Machine machine;
  std::vector<SolverRow> rows;
  std::string opensees;  ///< its version; if not measured, the reason
  bool has_opensees = false;
  GateResult result = GateResult::NotJudged;
};

/// Steps of the plant of solid elements on 486 bearings under a recorded motion, in one thread
/// without priority. A step in which the kernel took the processor away is excused, and counted.
/// @throws Error if a plant cannot be made, or the record is missing   @setup
[[nodiscard]] SolverReport run_solver_bench(const SolverOptions& options);

/// The report as one JSON document, or as a table of text.
[[nodiscard]] std::string to_json(const SolverReport& report);
[[nodiscard]] std::string to_text(const SolverReport& report);

}  // namespace rths::bench
