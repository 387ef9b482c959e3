// SPDX-License-Identifier: Apache-2.0
#include "energy_count.hpp"

namespace rths::plant {
namespace {

// By the trapezoidal rule, over a motion.
double work(const VectorXd& force, const VectorXd& force_before, const auto& motion,
            const auto& motion_before) {
  return 0.5 * (force + force_before).dot(motion - motion_before);
}

}  // namespace

EnergyCount::EnergyCount(const LargePlantAnalysis& plant)
    : last_displacement_{plant.state_.u},
      product_{VectorXd::Zero(plant.state_.u.size())},
      corrected_{MatrixXd::Zero(plant.bearing_motion_.rows(), 2)},
      last_corrected_{corrected_} {
  const VectorXd none = VectorXd::Zero(corrected_.rows());
  now_ = before_ = {product_, none, none, product_};
}

void EnergyCount::add_step(const LargePlantAnalysis& plant) noexcept {
  plant.motion_at_bearings(plant.state_.u, plant.state_.v, corrected_);
  find_forces(plant);
  const auto at = corrected_.col(0), last = last_corrected_.col(0);
  const VectorXd& u = plant.state_.u;
  const double all = plant.bearings_.stands_for();
  energy_.absorbed += all * work(now_.bearings, before_.bearings, at, last);
  energy_.damped += work(now_.damping, before_.damping, u, last_displacement_) -
                    all * work(now_.not_damped, before_.not_damped, at, last);
  energy_.input -= work(now_.ground, before_.ground, u, last_displacement_);
  find_levels(plant);
  std::swap(now_, before_);
  corrected_.swap(last_corrected_);
  last_displacement_ = u;
}

void EnergyCount::find_forces(const LargePlantAnalysis& plant) noexcept {
  const auto& state = plant.state_;
  plant.multiply_stiffness(state.v, now_.damping);
  now_.damping *= plant.damping_time();
  plant.multiply_inertia(plant.ground_, now_.ground);
  plant.bearings_.forces(plant.bearing_motion_, plant.correction_, now_.bearings);
  plant.bearings_.damping(corrected_, now_.not_damped);
}

void EnergyCount::find_levels(const LargePlantAnalysis& plant) noexcept {
  const auto& state = plant.state_;
  plant.multiply_mass(state.v, product_);
  energy_.kinetic = 0.5 * state.v.dot(product_);
  plant.multiply_stiffness(state.u, product_);
  energy_.strain = 0.5 * state.u.dot(product_) -
                   plant.bearings_.stands_for() * plant.bearings_.strain(corrected_);
}

}  // namespace rths::plant
