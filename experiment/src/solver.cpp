// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

namespace rths::experiment {
namespace {

constexpr int kMostSubsteps = 100;  // of the integration between targets

}  // namespace

Solver read_solver(const Config& table) {
  Solver solver;
  solver.alpha = table.number_in("alpha", -1.0 / 3, 0, solver.alpha);
  solver.substeps =
      static_cast<int>(table.integer_in("substeps", 1, kMostSubsteps, solver.substeps));
  solver.wait_deadline = table.number_in("wait_deadline_s", 0.01, 100, solver.wait_deadline);
  auto& time = solver.computing_time;
  solver.models_computing_time = table.flag("model_computing_time", false);
  time.mean = table.number_in("computing_time_s", 0, 10, time.mean);
  time.spread = table.number_in("computing_time_spread", 0, 1, time.spread);
  time.overrun_fraction = table.number_in("overrun_fraction", 0, 1, time.overrun_fraction);
  time.overrun = table.number_in("overrun_s", 0, 10, time.overrun);
  table.reject_unknown_keys();
  return solver;
}

}  // namespace rths::experiment
