// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/large_plant_analysis.hpp>

#include <algorithm>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "energy_count.hpp"
#include "floor_monitors.hpp"
#include "shapes.hpp"

namespace rths::plant {
namespace {

const PlantSettings& checked(const PlantSettings& settings, std::size_t bearings) {
  if (!(settings.time_step > 0))
    throw Error{fmt::format("plant: the time step is {:g} s, expected a positive number",
                            settings.time_step)};
  if (!(settings.alpha >= -1.0 / 3 && settings.alpha <= 0))
    throw Error{fmt::format("plant: alpha is {:g}, expected -1/3 to 0", settings.alpha)};
  if (!(settings.damping_ratio >= 0 && settings.damping_ratio < 1 &&
        settings.damping_frequency > 0))
    throw Error{fmt::format(
        "plant: damping is {:g} at {:g} Hz, expected a ratio of 0 to 1 at a positive frequency",
        settings.damping_ratio, settings.damping_frequency)};
  if (settings.tested_bearing >= bearings)
    throw Error{fmt::format("plant: bearing {} is tested, but there are {}",
                            settings.tested_bearing + 1, bearings)};
  return settings;
}

Index row_of(std::size_t bearing) { return static_cast<Index>(kDirections * bearing); }

}  // namespace

double PlantSettings::damping_time() const {
  return damping_ratio / (std::numbers::pi * damping_frequency);
}

LargePlantAnalysis::LargePlantAnalysis(const BearingSet& bearings, const VectorXd& weights,
                                       sim::GroundMotion motion, const std::vector<Floor>& floors,
                                       const PlantSettings& settings)
    : settings_{checked(settings, bearings.kind_of.size())},
      beta_{(1 - settings.alpha) * (1 - settings.alpha) / 4},
      gamma_{(1 - 2 * settings.alpha) / 2},
      damping_time_{settings.damping_time()},
      implicit_share_{(1 + settings.alpha) * settings.time_step *
                      (gamma_ * damping_time_ + beta_ * settings.time_step)},
      motion_{std::move(motion)},
      bearings_{bearings, weights, settings.time_step, settings.damps_bearings ? 0 : damping_time_},
      floors_{floors.size()},
      bearing_motion_{MatrixXd::Zero(row_of(bearings.kind_of.size()), 2)},
      correction_{VectorXd::Zero(up_to_multiple(bearing_motion_.rows(), Shapes::kLine))},
      last_correction_{correction_},
      mixed_correction_{correction_},
      floor_acceleration_{VectorXd::Zero(row_of(floors_))} {}

void LargePlantAnalysis::begin_at_rest(Index size) {
  for (auto* each :
       {&state_.u, &state_.v, &state_.a, &state_.predicted_u, &state_.predicted_v, &state_.w})
    each->setZero(size);
  if (settings_.counts_energy) energy_ = std::make_unique<EnergyCount>(*this);
}

LargePlantAnalysis::~LargePlantAnalysis() = default;

EnergyBalance LargePlantAnalysis::energy() const noexcept {
  return energy_ ? energy_->energy() : EnergyBalance{};
}

std::vector<sim::InterfaceDof> LargePlantAnalysis::interface() const {
  return sim::plant_interface();
}

void LargePlantAnalysis::predict(std::span<double> target, std::span<double> rate) noexcept {
  ++steps_;
  const double h = settings_.time_step, alpha = settings_.alpha;
  auto& [u, v, a, predicted_u, predicted_v, w] = state_;
  predicted_u = u + h * v + h * h * (0.5 - beta_) * a;
  predicted_v = v + h * (1 - gamma_) * a;
  w = (1 + alpha) * (predicted_u + damping_time_ * predicted_v) - alpha * (u + damping_time_ * v);
  const Eigen::Matrix<double, 3, 2> motion = tested_motion();
  for (Index k = 0; k < 2; ++k) {
    target[static_cast<std::size_t>(k)] = motion(k, 0);
    rate[static_cast<std::size_t>(k)] = motion(k, 1);
  }
  // A bearing cannot pull: what holds it in tension is not the machine's.
  const double weight = bearings_.compression(settings_.tested_bearing, 0);
  target[2] = std::max(bearings_.compression(settings_.tested_bearing, motion(2, 0)), 0.0) - weight;
  rate[2] = 0;
  has_worked_ = false;
}

void LargePlantAnalysis::work_ahead() noexcept {
  if (has_worked_) return;
  has_worked_ = true;
  bearing_motion(bearing_motion_);
  bearings_.advance(bearing_motion_, settings_.tested_bearing, correction_);
  const double alpha = settings_.alpha;
  mixed_correction_ =
      bearings_.stands_for() * ((1 + alpha) * correction_ - alpha * last_correction_);
  const Eigen::Vector3d ground = ground_at(motion_, time());
  solve((1 + alpha) * ground - alpha * ground_, mixed_correction_);
  ground_ = ground;
}

void LargePlantAnalysis::correct(std::span<const double> force) noexcept {
  work_ahead();
  const std::size_t tested = settings_.tested_bearing;
  const Eigen::Matrix<double, 3, 2> motion = tested_motion();
  const Eigen::Vector2d correction = bearings_.correction_for(
      tested, {force[0], force[1]}, motion.col(0).head<2>(), motion.col(1).head<2>());
  add_tested(bearings_.stands_for() * (1 + settings_.alpha) * correction);
  correction_.segment<2>(row_of(tested)) = correction;
  last_correction_ = correction_;
  const double h = settings_.time_step;
  state_.u = state_.predicted_u + beta_ * h * h * state_.a;
  state_.v = state_.predicted_v + gamma_ * h * state_.a;
  if (energy_) energy_->add_step(*this);
}

std::vector<sim::MonitoredQuantity> LargePlantAnalysis::monitors() const {
  auto monitors = monitors_of(floors_);
  monitors.push_back({"bearings.least_load", "N"});
  monitors.push_back({"bearings.largest_load", "N"});
  monitors.push_back({"bearings.lifted", "1"});
  return monitors;
}

void LargePlantAnalysis::monitor(std::span<double> values) const noexcept {
  floor_motion(floor_acceleration_);
  const std::size_t motions = values.size() - 3;
  write_monitors(ground_, floor_acceleration_, values.first(motions));
  const BearingField::Loads& loads = bearings_.loads();
  values[motions] = loads.least;
  values[motions + 1] = loads.largest;
  values[motions + 2] = loads.lifted;
}

}  // namespace rths::plant
