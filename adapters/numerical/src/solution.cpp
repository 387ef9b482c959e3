// SPDX-License-Identifier: Apache-2.0
#include "solution.hpp"

#include <algorithm>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

// Untested directions get no ground motion.
sim::GroundMotion along_tested_axes(sim::GroundMotion motion,
                                    const std::vector<std::string>& axes) {
  const auto tested = [&](const char* axis) {
    return std::find(axes.begin(), axes.end(), axis) != axes.end();
  };
  if (!tested("long"))
    std::fill(motion.long_acceleration.begin(), motion.long_acceleration.end(), 0);
  if (!tested("lat")) std::fill(motion.lat_acceleration.begin(), motion.lat_acceleration.end(), 0);
  return motion;
}

constexpr const char* kDirections[] = {"long", "lat"};

}  // namespace

AnalysedTargets::AnalysedTargets(const NumericalSettings& settings)
    : analysis_{sim::assemble(settings.plant),
                along_tested_axes(settings.motion, settings.axes),
                settings.bearing_initial_stiffness,
                settings.integration_step,
                settings.alpha,
                settings.vertical_feedback,
                settings.substeps} {}

void AnalysedTargets::begin(Exchange& exchange) noexcept {
  exchange.displacement = analysis_.predict();
  exchange.velocity = analysis_.predicted_velocity();
  exchange.vertical_force = analysis_.vertical_force();
}

MonitorNames AnalysedTargets::monitors() const {
  MonitorNames names;
  for (const char* direction : kDirections)
    names.emplace_back(std::string{"ground.accel."} + direction, "m/s2");
  for (std::size_t floor = 0; floor < analysis_.plant().floors.size(); ++floor)
    for (const char* direction : kDirections)
      names.emplace_back("floor." + std::to_string(floor + 1) + ".accel." + direction, "m/s2");
  return names;
}

void AnalysedTargets::monitor(std::span<double> values) const noexcept {
  const Eigen::Vector2d ground = analysis_.ground_acceleration();
  values[0] = ground[0];
  values[1] = ground[1];
  for (std::size_t floor = 0; floor < analysis_.plant().floors.size(); ++floor) {
    const Eigen::Vector2d acceleration = analysis_.floor_acceleration(floor);
    values[2 + 2 * floor] = acceleration[0];
    values[3 + 2 * floor] = acceleration[1];
  }
}

PlayedTargets::PlayedTargets(const experiment::DisplacementHistory& history,
                             double integration_step)
    : history_{history}, integration_step_{integration_step} {
  if (!(history_.time_step > 0) || history_.displacement_long.size() < 2 ||
      history_.displacement_long.size() != history_.displacement_lat.size())
    throw Error{"displacement history: expected a time step and two equally long axes"};
}

// Linear between samples; constant after the last.
Eigen::Vector2d PlayedTargets::at(double time) const noexcept {
  const double last = static_cast<double>(history_.displacement_long.size() - 1);
  const double position = std::clamp(time / history_.time_step, 0.0, last);
  const auto i =
      std::min(static_cast<std::size_t>(position), history_.displacement_long.size() - 2);
  const double fraction = position - static_cast<double>(i);
  const auto between = [&](const std::vector<double>& values) {
    return (1 - fraction) * values[i] + fraction * values[i + 1];
  };
  return {between(history_.displacement_long), between(history_.displacement_lat)};
}

void PlayedTargets::begin(Exchange& exchange) noexcept {
  const Eigen::Vector2d before = at(time());
  ++step_;
  exchange.displacement = at(time());
  exchange.velocity = (exchange.displacement - before) / integration_step_;
}

Solution make_solution(const NumericalSettings& settings) {
  if (settings.history) return PlayedTargets{*settings.history, settings.integration_step};
  return AnalysedTargets{settings};
}

}  // namespace rths::adapters
