// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/force_feedback.hpp>

namespace rths::loop {

ForceFeedback::ForceFeedback(const ForceCorrection& correction,
                             const std::optional<controller::TargetForceSettings>& target_force,
                             double period)
    : leads_{target_force && target_force->lead_time > 0} {
  for (std::size_t i = 0; i < 2; ++i)
    if (const auto* paper = std::get_if<MachineForceCorrection>(&correction))
      by_slope_.emplace_back(paper->machine[i], period, paper->slope_samples);
    else if (const auto* table = std::get_if<TableForceCorrection>(&correction))
      by_table_.emplace_back(table->machine[i], table->settings);
  if (target_force) target_force_.emplace(*target_force);
}

AxisMeasurement ForceFeedback::corrected(const AxisMeasurement& measured, bool waits) {
  AxisMeasurement specimen = measured;
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    const double x = measured.displacement[i], a = measured.acceleration[i];
    if (!by_slope_.empty()) specimen.force[i] = by_slope_[axis].step(x, a, measured.force[i]);
    if (by_table_.empty()) continue;
    auto& observer = by_table_[axis];
    specimen.force[i] = observer.step({x, a, measured.force[i], measured.axial_load});
    if (waits) specimen.displacement[i] = observer.displacement();
  }
  return specimen;
}

void ForceFeedback::step(const AxisMeasurement& specimen, const Eigen::VectorXd& target,
                         const Command& last) {
  at_target_ = ahead_ = specimen.force;
  if (!target_force_) return;
  target_force_->step({target.data(), specimen.displacement.data(), specimen.acceleration.data(),
                       specimen.force.data(), last.displacement.data(), last.velocity.data(),
                       last.acceleration.data(), specimen.axial_load},
                      true);
  at_target_ += target_force_->correction();
  if (leads_) ahead_ = target_force_->ahead();
}

}  // namespace rths::loop
