// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/large_plant_analysis.hpp>

#include <algorithm>
#include <cmath>
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
  if (settings.substeps < 1)
    throw Error{fmt::format("integrator: {} substeps, expected at least 1", settings.substeps)};
  if (settings.counts_energy && settings.substeps > 1)
    throw Error{
        fmt::format("plant: energy is counted with 1 substep, not with {}", settings.substeps)};
  if (settings.tested_bearing >= bearings)
    throw Error{fmt::format("plant: bearing {} is tested, but there are {}",
                            settings.tested_bearing + 1, bearings)};
  return settings;
}

// A mass m on a bearing k alone is stable with steps up to 3 √(m/k); 1 is reached at 1 √(m/k).
constexpr double kLargestShare = 1;

Index row_of(std::size_t bearing) { return static_cast<Index>(kDirections * bearing); }

// Of the last three values of a quantity, the last one in the parabola through them.
double share_of_parabola(double x) { return x * (1 + x) / 2; }
// The last one of two in the straight line through them, a step later.
double share_of_line(double x) { return 1 + x; }

}  // namespace

double PlantSettings::damping_time() const {
  return damping_ratio / (std::numbers::pi * damping_frequency);
}

LargePlantAnalysis::LargePlantAnalysis(const BearingSet& bearings, const VectorXd& weights,
                                       sim::GroundMotion motion, const std::vector<Floor>& floors,
                                       const PlantSettings& settings)
    : settings_{checked(settings, bearings.kind_of.size())},
      step_{settings.time_step / settings.substeps},
      beta_{(1 - settings.alpha) * (1 - settings.alpha) / 4},
      gamma_{(1 - 2 * settings.alpha) / 2},
      damping_time_{settings.damping_time()},
      implicit_share_{(1 + settings.alpha) * step_ * (gamma_ * damping_time_ + beta_ * step_)},
      motion_{std::move(motion)},
      bearings_{bearings, weights, step_, settings.damps_bearings ? 0 : damping_time_},
      floors_{floors.size()},
      bearing_motion_{MatrixXd::Zero(row_of(bearings.kind_of.size()), 2)},
      correction_{VectorXd::Zero(up_to_multiple(bearing_motion_.rows(), Shapes::kPanel))},
      last_correction_{correction_},
      mixed_correction_{correction_},
      floor_acceleration_{VectorXd::Zero(row_of(floors_))},
      tested_{TestedForce::Zero(settings.measures_vertical ? 3 : 2)},
      next_tested_{tested_},
      substeps_ahead_{settings.substeps} {}

void LargePlantAnalysis::begin_at_rest(Index size) {
  const auto rest = [&] {
    for (auto* each :
         {&state_.u, &state_.v, &state_.a, &state_.predicted_u, &state_.predicted_v, &state_.w})
      each->setZero(size);
  };
  rest();
  if (settings_.counts_energy) energy_ = std::make_unique<EnergyCount>(*this);
  if (settings_.substeps == 1) return;
  find_responses();
  require_slow_bearing();
  rest();
  floor_acceleration_.setZero();
  substeps_ahead_ = 0;
  while (!is_ahead()) integrate_substep();
}

// Two steps of a plant whose other bearings are their initial springs, from rest.
void LargePlantAnalysis::find_responses() {
  const Index size = state_.u.size(), row = row_of(settings_.tested_bearing);
  const double alpha = settings_.alpha;
  const Index directions = tested_.size();
  for (MatrixXd* each : {&responses_.u, &responses_.v, &responses_.a})
    each->resize(size, directions);
  responses_.floors.resize(floor_acceleration_.size(), directions);
  for (Index k = 0; k < directions; ++k) {
    for (VectorXd* each : {&state_.u, &state_.v, &state_.a}) each->setZero();
    double last = 0;
    for (const auto share : {share_of_parabola, share_of_line}) {
      for (int i = 1; i <= settings_.substeps; ++i) {
        const double now = share(static_cast<double>(i) / settings_.substeps);
        predict_state();
        mixed_correction_.setZero();
        mixed_correction_[row + k] = bearings_.stands_for() * ((1 + alpha) * now - alpha * last);
        solve(Eigen::Vector3d::Zero(), mixed_correction_);
        correct_state();
        last = now;
      }
      if (share == share_of_parabola) floor_motion(floor_acceleration_);
    }
    responses_.u.col(k) = state_.u;
    responses_.v.col(k) = state_.v;
    responses_.a.col(k) = state_.a;
    responses_.floors.col(k) = floor_acceleration_;
  }
}

LargePlantAnalysis::~LargePlantAnalysis() = default;

EnergyBalance LargePlantAnalysis::energy() const noexcept {
  return energy_ ? energy_->energy() : EnergyBalance{};
}

std::vector<sim::InterfaceDof> LargePlantAnalysis::interface() const {
  return sim::plant_interface();
}

// What a bearing's initial spring does with the extrapolated force must not grow: the spring's
// force on the way to the next target, over the change that caused it.
void LargePlantAnalysis::require_slow_bearing() const {
  double largest = 0;
  for (Index k = 0; k < 2; ++k) {
    const VectorXd response = responses_.u.col(k);
    const Eigen::Vector2d motion = tested_motion(response, response).col(0).head<2>();
    largest = std::max(largest, spring_force(-motion)[k]);
  }
  if (largest <= kLargestShare) return;
  throw Error{fmt::format(
      "integrator: substeps need a step of at most {:.3g} s with a bearing of {:.3g} N/m, not "
      "{:.3g} s; shorten the step or set substeps to 1",
      settings_.time_step * std::sqrt(kLargestShare / largest), spring_force({1, 0})[0],
      settings_.time_step)};
}

// Of the tested bearing's initial spring.
Eigen::Vector2d LargePlantAnalysis::spring_force(const Eigen::Vector2d& displacement) const {
  const Eigen::Vector2d none = Eigen::Vector2d::Zero();
  return -bearings_.correction_for(settings_.tested_bearing, none, displacement, none);
}

void LargePlantAnalysis::predict_state() noexcept {
  const double h = step_, alpha = settings_.alpha;
  auto& [u, v, a, predicted_u, predicted_v, w] = state_;
  predicted_u = u + h * v + h * h * (0.5 - beta_) * a;
  predicted_v = v + h * (1 - gamma_) * a;
  w = (1 + alpha) * (predicted_u + damping_time_ * predicted_v) - alpha * (u + damping_time_ * v);
}

void LargePlantAnalysis::correct_state() noexcept {
  state_.u = state_.predicted_u + beta_ * step_ * step_ * state_.a;
  state_.v = state_.predicted_v + gamma_ * step_ * state_.a;
}

void LargePlantAnalysis::predict(std::span<double> target, std::span<double> rate) noexcept {
  ++steps_;
  const bool is_single = settings_.substeps == 1;
  if (is_single) predict_state();
  target_motion_ = tested_motion(target_displacement(), is_single ? state_.predicted_v : state_.v);
  for (Index k = 0; k < 2; ++k) {
    target[static_cast<std::size_t>(k)] = target_motion_(k, 0);
    rate[static_cast<std::size_t>(k)] = target_motion_(k, 1);
  }
  // A bearing cannot pull: what holds it in tension is not the machine's.
  const double weight = bearings_.compression(settings_.tested_bearing, 0);
  target[2] =
      std::max(bearings_.compression(settings_.tested_bearing, target_motion_(2, 0)), 0.0) - weight;
  rate[2] = 0;
  substeps_ahead_ = 0;
}

// Of all bearings but the tested one, whose d is `tested`.
void LargePlantAnalysis::solve_step(double time, const TestedForce& tested) noexcept {
  bearing_motion(bearing_motion_);
  bearings_.advance(bearing_motion_, settings_.tested_bearing, correction_);
  correction_.segment(row_of(settings_.tested_bearing), tested.size()) = tested;
  const double alpha = settings_.alpha;
  mixed_correction_ =
      bearings_.stands_for() * ((1 + alpha) * correction_ - alpha * last_correction_);
  const Eigen::Vector3d ground = ground_at(motion_, time);
  solve((1 + alpha) * ground - alpha * ground_, mixed_correction_);
  ground_ = ground;
}

void LargePlantAnalysis::work_ahead() noexcept {
  if (is_ahead()) return;
  if (settings_.substeps > 1) {
    if (substeps_ahead_ == 0) floor_motion(floor_acceleration_), monitored_ground_ = ground_;
    integrate_substep();
    return;
  }
  solve_step(time(), TestedForce::Zero(tested_.size()));
  monitored_ground_ = ground_;
  substeps_ahead_ = 1;
}

// d of the tested bearing continues the straight line through its last two values.
void LargePlantAnalysis::integrate_substep() noexcept {
  const double x = static_cast<double>(++substeps_ahead_) / settings_.substeps;
  predict_state();
  solve_step(time() + x * settings_.time_step, next_tested_ + x * (next_tested_ - tested_));
  correct_state();
  last_correction_ = correction_;
}

void LargePlantAnalysis::correct(std::span<const double> force) noexcept {
  while (!is_ahead()) work_ahead();
  const std::size_t tested = settings_.tested_bearing;
  TestedForce correction{tested_.size()};
  correction.head<2>() =
      bearings_.correction_for(tested, {force[0], force[1]}, target_motion_.col(0).head<2>(),
                               target_motion_.col(1).head<2>());
  if (settings_.measures_vertical)
    correction[2] = bearings_.vertical_correction_for(force[2], target_motion_(2, 0));
  if (settings_.substeps > 1) {
    correct_with_substeps(correction);
    return;
  }
  add_tested(bearings_.stands_for() * (1 + settings_.alpha) * correction);
  correction_.segment(row_of(tested), correction.size()) = correction;
  last_correction_ = correction_;
  correct_state();
  if (energy_) energy_->add_step(*this);
}

void LargePlantAnalysis::correct_with_substeps(const TestedForce& correction) noexcept {
  const TestedForce change = correction - next_tested_;
  state_.u.noalias() += responses_.u * change;
  state_.v.noalias() += responses_.v * change;
  state_.a.noalias() += responses_.a * change;
  floor_acceleration_.noalias() += responses_.floors * change;
  last_correction_.segment(row_of(settings_.tested_bearing), change.size()) +=
      share_of_line(1) * change;
  next_tested_ = 2 * correction - tested_;
  tested_ = correction;
}

std::vector<sim::MonitoredQuantity> LargePlantAnalysis::monitors() const {
  auto monitors = monitors_of(floors_);
  monitors.push_back({"bearings.least_load", "N"});
  monitors.push_back({"bearings.largest_load", "N"});
  monitors.push_back({"bearings.lifted", "1"});
  if (energy_)
    for (const char* name : {"kinetic", "strain", "damped", "absorbed", "input"})
      monitors.push_back({fmt::format("energy.{}", name), "J"});
  return monitors;
}

void LargePlantAnalysis::monitor(std::span<double> values) const noexcept {
  if (settings_.substeps == 1) floor_motion(floor_acceleration_);
  const std::size_t motions = kDirections * (1 + floors_);
  write_monitors(monitored_ground_, floor_acceleration_, values.first(motions));
  const BearingField::Loads& loads = bearings_.loads();
  values[motions] = loads.least;
  values[motions + 1] = loads.largest;
  values[motions + 2] = loads.lifted;
  if (!energy_) return;
  const EnergyBalance& energy = energy_->energy();
  std::size_t at = motions + 3;
  for (const double part :
       {energy.kinetic, energy.strain, energy.damped, energy.absorbed, energy.input})
    values[at++] = part;
}

}  // namespace rths::plant
