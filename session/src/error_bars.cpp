// SPDX-License-Identifier: Apache-2.0
#include "error_bars.hpp"

#include <algorithm>
#include <cmath>

#include <rths/app/builtin_adapters.hpp>

namespace rths::session {
namespace {

using experiment::Experiment;

double value_at(const std::vector<double>& values, double place) {
  const auto at = static_cast<std::size_t>(place);
  if (at >= values.size()) return 0;
  const double next = at + 1 < values.size() ? values[at + 1] : values[at];
  return values[at] + (next - values[at]) * (place - static_cast<double>(at));
}

// In steps of the simulation. The time of a record is that of the wall.
loop::AddedForce remainder_of(const diagnosis::ForceRemainder& found, double rate, double step) {
  const std::size_t rows = std::max(found.force[0].size(), found.force[1].size());
  if (rows == 0) return {};
  const double rows_per_step = step * rate / found.time_step;
  loop::AddedForce force;
  for (double place = 0; place < static_cast<double>(rows); place += rows_per_step)
    force.emplace_back(value_at(found.force[0], place), value_at(found.force[1], place));
  return force;
}

}  // namespace

void add_response_bands(const std::filesystem::path& experiment,
                        const experiment::Overrides& changes, diagnosis::Verdict& verdict) {
  const auto& improvement = verdict.improvement;
  if (improvement.fragment.empty() || improvement.deviations.empty()) return;
  const auto improved = [&](const std::string& fragment) {
    return experiment::load_experiment(app::builtin_adapters(), experiment, changes, fragment);
  };
  const Experiment fitted = improved(improvement.fragment);
  if (fitted.reference || fitted.history || !fitted.solves_plant()) return;
  budget::UncertainSimulation simulation;
  simulation.structure = fitted.plant.structure;
  simulation.motion = fitted.tested_motion();
  simulation.time_step = experiment::kReferenceStep;
  simulation.duration = fitted.time.duration;
  simulation.fitted = fitted.model.bearing;
  for (const auto& fragment : improvement.deviations)
    simulation.deviating.push_back(improved(fragment).model.bearing);
  simulation.remainder =
      remainder_of(improvement.remainder, fitted.time.rate, simulation.time_step);
  auto bands = budget::response_bands(simulation);
  // An axis that is not tested does not move.
  std::erase_if(bands.peaks, [](const budget::PeakBand& peak) { return peak.high <= 0; });
  verdict.bands = std::move(bands);
}

}  // namespace rths::session
