// SPDX-License-Identifier: Apache-2.0
#include "tables.hpp"

#include <algorithm>

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

double ComputingTimes::draw() noexcept {
  std::normal_distribution<double> normal{model_.mean, model_.spread * model_.mean};
  std::uniform_real_distribution<double> uniform{0, 1};
  const double usual = std::clamp(normal(random_), 0.0, 2 * model_.mean);
  return usual + (uniform(random_) < model_.overrun_fraction ? model_.overrun : 0);
}

}  // namespace rths::experiment
