// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/plant_analysis.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

constexpr double kLargestPhase = 0.8;  // of the basemat on its bearings, in a step [rad]

// The bearings act on the basemat, whose two degrees of freedom come first.
Eigen::MatrixXd implicit_stiffness(const PlantMatrices& plant, double bearing_stiffness) {
  Eigen::MatrixXd K = plant.K;
  K.topLeftCorner(2, 2).diagonal().array() += plant.bearings * bearing_stiffness;
  return K;
}

int at_least_one(int substeps) {
  if (substeps < 1)
    throw Error{fmt::format("integrator: {} substeps, expected at least 1", substeps)};
  return substeps;
}

// An extrapolated force is explicit: the basemat alone on its bearings must be slow in a step.
void require_slow_bearing(const PlantMatrices& plant, double bearing_stiffness, double time_step) {
  const double omega = std::sqrt(plant.bearings * bearing_stiffness / plant.M(0, 0));
  if (omega * time_step <= kLargestPhase) return;
  throw Error{fmt::format(
      "integrator: substeps need a step of at most {:.3g} s with a bearing of {:.3g} N/m, not "
      "{:.3g} s; shorten the step or set substeps to 1",
      kLargestPhase / omega, bearing_stiffness, time_step)};
}

// A plant on a fixed base has no bearings and no vertical mode.
OscillatorStep vertical_step(const PlantMatrices& plant, double time_step) {
  if (plant.bearings == 0) return {};
  return oscillator_step(2 * std::numbers::pi * plant.vertical_frequency, plant.vertical_damping,
                         time_step);
}

}  // namespace

void BearingPath::append(const Eigen::Vector2d& value) noexcept {
  before = last;
  last = now;
  now = value;
}

Eigen::Vector2d BearingPath::at(double x) const noexcept {
  return last + x * (now - last) - x * (1 - x) / 2 * (now - 2 * last + before);
}

// NOLINTNEXTLINE(readability-function-size)
PlantAnalysis::PlantAnalysis(PlantMatrices plant, GroundMotion motion,
                             double bearing_initial_stiffness, double time_step, double alpha,
                             VerticalFeedback vertical, int substeps)
    : plant_{std::move(plant)},
      motion_{std::move(motion)},
      time_step_{time_step},
      substeps_{at_least_one(substeps)},
      bearing_stiffness_{plant_.bearings * bearing_initial_stiffness},
      inertia_{-plant_.M * plant_.iota},
      load_{Eigen::VectorXd::Zero(plant_.dofs())},
      restoring_force_{Eigen::VectorXd::Zero(plant_.dofs())},
      integrator_{plant_.M, plant_.C, implicit_stiffness(plant_, bearing_initial_stiffness),
                  time_step / substeps_, alpha},
      vertical_step_{vertical_step(plant_, time_step)} {
  if (substeps_ > 1) {
    require_slow_bearing(plant_, bearing_initial_stiffness, time_step);
    extrapolation_.emplace(plant_.M, plant_.C, plant_.K, time_step / substeps_, alpha);
  }
  if ((plant_.overturning.array() != 0).any()) {
    overturning_stiffness_ = plant_.K * plant_.overturning;
    overturning_damping_ = plant_.C * plant_.overturning;
  }
  if (vertical == VerticalFeedback::Model || plant_.bearings == 0) return;
  const double omega = 2 * std::numbers::pi * plant_.vertical_frequency;
  vertical_stiffness_ = plant_.mass_per_bearing * omega * omega;
  vertical_damping_ = 2 * plant_.vertical_damping * omega * plant_.mass_per_bearing;
  const auto one = [](double value) { return Eigen::MatrixXd::Constant(1, 1, value); };
  vertical_integrator_.emplace(one(plant_.mass_per_bearing), one(vertical_damping_),
                               one(vertical_stiffness_), time_step, alpha);
  vertical_restoring_ = vertical_load_ = Eigen::VectorXd::Zero(1);
}

// The masses push their sticks with K u + C v: their inertia forces.
double PlantAnalysis::predicted_overturning() const noexcept {
  if (overturning_stiffness_.size() == 0) return 0;
  const Eigen::VectorXd& u =
      extrapolation_ ? extrapolation_->displacement() : integrator_.predicted_displacement();
  const Eigen::VectorXd& v =
      extrapolation_ ? extrapolation_->velocity() : integrator_.predicted_velocity();
  return overturning_stiffness_.dot(u) + overturning_damping_.dot(v);
}

// A bearing cannot pull.
void PlantAnalysis::predict_vertical() noexcept {
  double force = overturning_ = predicted_overturning();
  if (vertical_integrator_) {
    const double compression = vertical_integrator_->predict()[0];
    force += vertical_stiffness_ * compression +
             vertical_damping_ * vertical_integrator_->predicted_velocity()[0];
  } else {
    const double before = motion_.vertical_at(static_cast<double>(steps_ - 1) * time_step_);
    force += plant_.mass_per_bearing *
             vertical_.advance(vertical_step_, before, motion_.vertical_at(time_));
  }
  vertical_force_ = std::max(force, -plant_.mass_per_bearing * kStandardGravity);
}

Eigen::Vector2d PlantAnalysis::predict() noexcept {
  time_ = static_cast<double>(++steps_) * time_step_;
  if (extrapolation_)
    extrapolate();
  else
    restoring_force_.noalias() = plant_.K * integrator_.predict();
  if (plant_.bearings > 0) predict_vertical();
  return extrapolation_ ? target_.now : integrator_.predicted_displacement().head<2>();
}

void PlantAnalysis::load_at(double time) noexcept { load_.noalias() = inertia_ * motion_.at(time); }

// The force continues the straight line through its last two values.
void PlantAnalysis::extrapolate() noexcept {
  extrapolation_->continue_from(integrator_);
  for (int i = 1; i <= substeps_; ++i) {
    const double x = static_cast<double>(i) / substeps_;
    restoring_force_.noalias() = plant_.K * extrapolation_->predict();
    restoring_force_.head<2>() += force_.now + x * (force_.now - force_.last);
    load_at(time_ - (1 - x) * time_step_);
    extrapolation_->correct(restoring_force_, load_);
  }
  target_.append(extrapolation_->displacement().head<2>());
}

// The operator splitting of α-OS, around the path through the targets.
void PlantAnalysis::interpolate() noexcept {
  for (int i = 1; i <= substeps_; ++i) {
    const double x = static_cast<double>(i) / substeps_;
    const Eigen::VectorXd& predicted = integrator_.predict();
    restoring_force_.noalias() = plant_.K * predicted;
    restoring_force_.head<2>() +=
        force_.at(x) + bearing_stiffness_ * (predicted.head<2>() - target_.at(x));
    load_at(time_ - (1 - x) * time_step_);
    integrator_.correct(restoring_force_, load_);
  }
}

void PlantAnalysis::correct(const Eigen::Vector2d& bearing_force, double vertical_force) noexcept {
  if (vertical_integrator_) {
    // The measured force contains the dashpot's at the predicted velocity, which α-OS adds itself,
    // and that of overturning, which all bearings together do not have.
    vertical_restoring_[0] = vertical_force - overturning_ -
                             vertical_damping_ * vertical_integrator_->predicted_velocity()[0];
    vertical_load_[0] = plant_.mass_per_bearing * motion_.vertical_at(time_);
    vertical_integrator_->correct(vertical_restoring_, vertical_load_);
  }
  ground_ = motion_.at(time_);
  if (extrapolation_) {
    force_.append(plant_.bearings * bearing_force);
    interpolate();
    return;
  }
  load_at(time_);
  restoring_force_.head<2>() += plant_.bearings * bearing_force;
  integrator_.correct(restoring_force_, load_);
}

Eigen::Vector2d PlantAnalysis::predicted_velocity() const {
  return extrapolation_ ? extrapolation_->velocity().head<2>()
                        : integrator_.predicted_velocity().head<2>();
}

Eigen::Vector2d PlantAnalysis::base_displacement() const {
  return integrator_.displacement().head<2>();
}

Eigen::Vector2d PlantAnalysis::floor_acceleration(std::size_t i) const {
  return integrator_.acceleration().segment<2>(plant_.floors[i]) + ground_;
}

std::vector<InterfaceDof> plant_interface() {
  return {InterfaceDof::of(Axis::Long), InterfaceDof::of(Axis::Lat),
          InterfaceDof::of(Axis::Vert, Controlled::Force)};
}

void PlantAnalysis::predict(std::span<double> target, std::span<double> rate) noexcept {
  const Eigen::Vector2d displacement = predict(), velocity = predicted_velocity();
  for (Eigen::Index i = 0; i < 2; ++i) {
    target[static_cast<std::size_t>(i)] = displacement[i];
    rate[static_cast<std::size_t>(i)] = velocity[i];
  }
  target[2] = vertical_force_;
  rate[2] = 0;
}

void PlantAnalysis::correct(std::span<const double> force) noexcept {
  correct({force[0], force[1]}, force[2]);
}

std::vector<MonitoredQuantity> PlantAnalysis::monitors() const {
  std::vector<MonitoredQuantity> monitors;
  const auto add = [&](const std::string& place) {
    for (const Axis axis : kHorizontal)
      monitors.push_back({place + ".accel." + name_of(axis), "m/s2"});
  };
  add("ground");
  for (std::size_t i = 0; i < plant_.floors.size(); ++i) add("floor." + std::to_string(i + 1));
  return monitors;
}

void PlantAnalysis::monitor(std::span<double> values) const noexcept {
  values[0] = ground_[0];
  values[1] = ground_[1];
  for (std::size_t i = 0; i < plant_.floors.size(); ++i) {
    const Eigen::Vector2d acceleration = floor_acceleration(i);
    values[2 + 2 * i] = acceleration[0];
    values[3 + 2 * i] = acceleration[1];
  }
}

}  // namespace rths::sim
