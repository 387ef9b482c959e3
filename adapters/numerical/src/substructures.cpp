// SPDX-License-Identifier: Apache-2.0
#include "substructures.hpp"

#include <algorithm>

#include <rths/core/error.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::adapters {
namespace {

/// Targets from a displacement history, independent of the specimen's force.
class PlayedTargets final : public sim::Substructure {
 public:
  PlayedTargets(const experiment::DisplacementHistory& history, double integration_step)
      : history_{history}, integration_step_{integration_step} {
    if (!(history_.time_step > 0) || history_.displacement_long.size() < 2 ||
        history_.displacement_long.size() != history_.displacement_lat.size())
      throw Error{"displacement history: expected a time step and two equally long axes"};
  }

  [[nodiscard]] std::vector<sim::InterfaceDof> interface() const override {
    return sim::plant_interface();
  }
  void predict(std::span<double> target, std::span<double> rate) RTHS_REALTIME override {
    const Eigen::Vector2d before = at(time());
    ++step_;
    const Eigen::Vector2d now = at(time()), velocity = (now - before) / integration_step_;
    for (Eigen::Index i = 0; i < 2; ++i) {
      target[static_cast<std::size_t>(i)] = now[i];
      rate[static_cast<std::size_t>(i)] = velocity[i];
    }
    target[2] = rate[2] = 0;
  }
  void correct(std::span<const double> /*force*/) RTHS_REALTIME override {}
  [[nodiscard]] double time() const RTHS_REALTIME override {
    return static_cast<double>(step_) * integration_step_;
  }

 private:
  [[nodiscard]] Eigen::Vector2d at(double time) const noexcept;

  experiment::DisplacementHistory history_;
  double integration_step_;
  std::size_t step_ = 0;
};

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

}  // namespace

std::unique_ptr<sim::Substructure> make_substructure(const NumericalSettings& settings) {
  if (settings.history)
    return std::make_unique<PlayedTargets>(*settings.history, settings.integration_step);
  return std::make_unique<sim::PlantAnalysis>(
      sim::assemble(settings.plant), settings.motion.along(horizontal_among(settings.axes)),
      settings.bearing_initial_stiffness, settings.integration_step, settings.alpha,
      settings.vertical_feedback, settings.substeps);
}

}  // namespace rths::adapters
