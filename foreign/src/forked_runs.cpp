// SPDX-License-Identifier: Apache-2.0
#include "forked_runs.hpp"

#include <algorithm>

#include "child.hpp"

namespace rths::foreign {
namespace {

constexpr double kSameRow = 1e-6;  // of a row

}  // namespace

double value_at(const std::vector<double>& rows, double place, bool is_held) {
  const auto last = static_cast<double>(rows.size() - 1);
  const double clamped = std::clamp(is_held ? place + kSameRow : place, 0.0, last);
  if (is_held) return rows[static_cast<std::size_t>(clamped)];
  const auto row = static_cast<std::size_t>(std::min(clamped, std::max(0.0, last - 1)));
  const double share = clamped - static_cast<double>(row);
  return share > 0 ? rows[row] + share * (rows[row + 1] - rows[row]) : rows[row];
}

std::vector<RunOutputs> ForkedRuns::results(std::span<const RunInputs* const> all) const {
  const TemporaryRun folder;
  std::size_t numbers = 0;
  for (const RunInputs* inputs : all) numbers += outputs * inputs->rows;
  const SharedNumbers shared{numbers};
  const auto work = [&] {
    double* next = shared.data();
    for (const RunInputs* inputs : all) {
      run(*inputs, next);
      next += outputs * inputs->rows;
    }
  };
  const ChildEnding ending =
      run_forked(work, folder.path(), deadline * static_cast<double>(all.size()));
  std::vector<RunOutputs> found(all.size());
  const double* next = shared.data();
  for (std::size_t k = 0; k < all.size(); ++k)
    for (std::size_t i = 0; i < outputs && ending.trouble.empty(); ++i, next += all[k]->rows)
      found[k].outputs.emplace_back(next, next + all[k]->rows);
  if (!ending.trouble.empty())
    for (auto& one : found) one.trouble = told(title, ending);
  return found;
}

RunOutputs ForkedSimulation::run(const RunInputs& inputs) const {
  const RunInputs* const one = &inputs;
  return run_forked_once({&one, 1})[0];
}

std::vector<RunOutputs> ForkedSimulation::run_each(std::span<const RunInputs* const> all) const {
  std::vector<RunOutputs> results = run_forked_once(all);
  if (all.size() > 1 && !results[0].trouble.empty()) return Simulation::run_each(all);
  return results;
}

}  // namespace rths::foreign
