// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <rths/adapters/numerical.hpp>
#include <rths/core/realtime.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::adapters {

/// Values exchanged with the specimen: long, lat. Untested axes stay at zero. The vertical axis
/// gets a force command.
struct Exchange {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< target [m]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();      ///< of the target [m/s]
  double vertical_force = 0;                               ///< on top of the weight [N]
  Eigen::Vector2d force = Eigen::Vector2d::Zero();         ///< measured [N]
  double measured_vertical_force = 0;  ///< on top of the weight, if it is fed back [N]
};

/// Name and SI unit of each recorded value.
using MonitorNames = std::vector<std::pair<std::string, std::string>>;

/// Targets from the analysis of a plant.
class AnalysedTargets {
 public:
  explicit AnalysedTargets(const NumericalSettings& settings);
  void begin(Exchange& exchange) RTHS_REALTIME;
  void finish(const Exchange& exchange) RTHS_REALTIME {
    analysis_.correct(exchange.force, exchange.measured_vertical_force);
  }
  [[nodiscard]] double time() const RTHS_REALTIME { return analysis_.time(); }
  [[nodiscard]] MonitorNames monitors() const;
  void monitor(std::span<double> values) const RTHS_REALTIME;

 private:
  sim::PlantAnalysis analysis_;
};

/// Targets from a displacement history, independent of the specimen's force.
class PlayedTargets {
 public:
  PlayedTargets(const experiment::DisplacementHistory& history, double integration_step);
  void begin(Exchange& exchange) RTHS_REALTIME;
  void finish(const Exchange&) RTHS_REALTIME {}
  [[nodiscard]] double time() const RTHS_REALTIME {
    return static_cast<double>(step_) * integration_step_;
  }
  [[nodiscard]] MonitorNames monitors() const { return {}; }
  void monitor(std::span<double>) const RTHS_REALTIME {}

 private:
  [[nodiscard]] Eigen::Vector2d at(double time) const noexcept;
  experiment::DisplacementHistory history_;
  double integration_step_;
  std::size_t step_ = 0;
};

/// Generates the targets.
using Solution = std::variant<AnalysedTargets, PlayedTargets>;

[[nodiscard]] Solution make_solution(const NumericalSettings& settings);

}  // namespace rths::adapters
