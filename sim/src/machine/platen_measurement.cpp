// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <rths/sim/machine/platen_run.hpp>

namespace rths::sim::machine {

TransducerFilter::TransducerFilter(double cutoff, double period) {
  const double k = std::tan(std::numbers::pi * cutoff * period);
  const double scale = 1 / (1 + std::numbers::sqrt2 * k + k * k);
  b0_ = k * k * scale;
  a1_ = 2 * (k * k - 1) * scale;
  a2_ = (1 - std::numbers::sqrt2 * k + k * k) * scale;
}

double TransducerFilter::operator()(double input) noexcept {
  const double output = b0_ * input + z1_;
  z1_ = 2 * b0_ * input - a1_ * output + z2_;
  z2_ = b0_ * input - a2_ * output;
  return output;
}

void TransducerFilter::reset(double input) noexcept {
  z2_ = (b0_ - a2_) * input;
  z1_ = (2 * b0_ - a1_) * input + z2_;
}

void PlatenRun::filter(bool reset) noexcept {
  for (Eigen::Index i = 0; i < 6; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double displacement = i < 3 ? state_.pose.position[i] : state_.pose.angles[i - 3];
    if (reset) {
      displacement_filter_[at].reset(displacement);
      force_filter_[at].reset(now_.actuator_force[i]);
    }
    filtered_displacement_[i] = displacement_filter_[at](displacement);
    filtered_force_[i] = force_filter_[at](now_.actuator_force[i]);
  }
  for (Eigen::Index i = 0; i < 3; ++i)
    filtered_acceleration_[i] =
        acceleration_filter_[static_cast<std::size_t>(i)](now_.rates.velocity[i]);
}

double PlatenRun::draw(double standard_deviation) noexcept {
  return standard_deviation * normal_(random_);
}

void PlatenRun::measure(PlatenFeedback& feedback) noexcept {
  const Transducers& t = machine_.transducers;
  feedback.displacement = filtered_displacement_;
  feedback.force = filtered_force_;
  feedback.force.head<2>() += t.force_offset;
  feedback.force[2] -= machine_.weight();
  for (Eigen::Index i = 0; i < 3; ++i) {
    feedback.displacement[i] += draw(t.displacement_noise);
    feedback.displacement[i + 3] += draw(t.rotation_noise);
    feedback.force[i] += draw(i < 2 ? t.force_noise : t.vertical_force_noise);
    feedback.force[i + 3] += draw(t.moment_noise);
    feedback.acceleration[i] = filtered_acceleration_[i] + draw(t.acceleration_noise);
  }
  const Eigen::Matrix3d R = state_.pose.rotation();
  const Eigen::Vector3d spin = R * state_.angular_velocity;
  for (std::size_t i = 0; i < kArms; ++i) {
    const Eigen::Vector3d& arm = machine_.outriggers.arm[i];
    feedback.outrigger_force[i] = machine_.outriggers.pair(push_of(state_, arm, R * arm, spin));
  }
}

}  // namespace rths::sim::machine
