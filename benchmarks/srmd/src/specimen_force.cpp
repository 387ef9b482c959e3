// SPDX-License-Identifier: Apache-2.0
#include "specimen_force.hpp"

namespace rths::bench {

SpecimenForce::SpecimenForce(const std::optional<ForceCorrection>& correction,
                             const Eigen::Vector2d& offset)
    : offset_{offset} {
  if (!correction) {
    const auto setup = controller::unison_eqs_setup();
    paper_.emplace_back(setup.long_axis, kPeriod);
    paper_.emplace_back(setup.lat_axis, kPeriod);
    return;
  }
  for (const auto& machine : correction->machine)
    observers_.emplace_back(machine, correction->observer);
  target_force_.emplace(correction->target_force);
  leads_ = correction->target_force.lead_time > 0;
}

void SpecimenForce::step(const sim::machine::PlatenFeedback& feedback,
                         const Eigen::VectorXd& target, const std::array<Command, 2>& commands) {
  Eigen::Vector2d displacement, force, x, v, a;
  const Eigen::Vector2d acceleration = feedback.acceleration.head<2>();
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    displacement[i] = feedback.displacement[i];
    x[i] = commands[axis][0];
    v[i] = commands[axis][1];
    a[i] = commands[axis][2];
    if (!target_force_) {
      force[i] =
          paper_[axis].step(displacement[i], acceleration[i], feedback.force[i] - offset_[i]);
      continue;
    }
    auto& observer = observers_[axis];
    force[i] =
        observer.step({displacement[i], acceleration[i], feedback.force[i], feedback.force[2]});
    displacement[i] = observer.displacement();
  }
  at_target_ = ahead_ = force;
  if (!target_force_) return;
  target_force_->step({target.data(), displacement.data(), acceleration.data(), force.data(),
                       x.data(), v.data(), a.data(), feedback.force[2]},
                      true);
  at_target_ += target_force_->correction();
  if (leads_) ahead_ = target_force_->ahead();
}

}  // namespace rths::bench
