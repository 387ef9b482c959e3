// SPDX-License-Identifier: Apache-2.0
#include "state_axes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/identification/signal.hpp>

namespace rths::diagnosis {

VectorXd dissipated_energy(const VectorXd& power, double time_step) {
  VectorXd energy(power.size());
  double work = 0;
  for (Index k = 0; k < power.size(); ++k) energy[k] = work += power[k] * time_step;
  for (Index k = power.size() - 2; k >= 0; --k) energy[k] = std::min(energy[k], energy[k + 1]);
  return energy.cwiseMax(0);
}

void add_state_axes(const std::vector<std::size_t>& axes, bool predicts_force,
                    const Channel* auxiliary, MotionDrive& drive) {
  const auto add = [&](const std::string& name, const VectorXd& values) {
    if (values.size() > 0) drive.states.emplace_back(name, drive.compared(values));
  };
  add("axial load [N]", drive.axial_load);
  add("temperature [K]", drive.temperature);
  if (auxiliary != nullptr)
    add(fmt::format("{} [{}]", auxiliary->role, auxiliary->unit), drive.auxiliary);
  if (!predicts_force) return;
  VectorXd power = VectorXd::Zero(drive.motion[axes[0]].size());
  for (const std::size_t axis : axes) {
    add(fmt::format("acceleration.{} [m/s2]", axis_name(axis)), drive.second_rate[axis]);
    power += drive.specimen_force[axis].cwiseProduct(drive.rate[axis]);
  }
  // Unfiltered: the filter overshoots where motion begins.
  const VectorXd energy = thinned(dissipated_energy(power, drive.model_step), drive.thinning);
  drive.states.emplace_back("dissipated energy [J]", energy.head(drive.measured.rows()));
}

}  // namespace rths::diagnosis
