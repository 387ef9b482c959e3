// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/sim/bearing.hpp>
#include <rths/sim/structure_model.hpp>

namespace rths::loop {

/// Response of a plant, one sample per step.
struct ResponseHistory {
  double time_step = 0;                                     ///< [s]
  std::vector<double> displacement_long, displacement_lat;  ///< of the bearing [m]
  std::vector<double> force_long, force_lat;                ///< of one bearing [N]
  struct Floor {
    std::string name;
    std::vector<double> acceleration_long, acceleration_lat;  ///< absolute [m/s²]
    std::vector<double> acceleration_vert;  ///< empty: the structure does not monitor it
  };
  std::vector<Floor> floors;

  /// Without samples.   @setup
  ResponseHistory(const std::vector<std::string>& floors, double time_step);
  ResponseHistory() = default;
  void append_displacement(const Eigen::Vector2d& displacement);
};

/// Appends the accelerations of floors, as a substructure monitors them, to a history.
class FloorMonitor {
 public:
  /// @throws Error if it does not monitor the floors of the history   @setup
  FloorMonitor(const sim::Substructure& substructure, const ResponseHistory& history);
  void append(const sim::Substructure& substructure, ResponseHistory& history);

 private:
  std::vector<double> values_;
  std::vector<std::size_t> places_;     ///< of long and lat of each floor, among the values
  std::vector<std::size_t> verticals_;  ///< of vert of each floor, or none
};

/// A force beside that of one bearing, by step: long, lat [N]. None after its end.
using AddedForce = std::vector<Eigen::Vector2d>;

/// The complete analysis with a bearing model instead of a specimen: the purely numerical result.
/// @param bearing  under its static load plus the vertical motion's contribution
/// @param duration  [s]
/// @param added  acts with the force of the bearing, which the history then contains, too   @setup
[[nodiscard]] ResponseHistory numerical_response(const sim::StructureModel& structure,
                                                 const sim::GroundMotion& motion,
                                                 const sim::Bearing& bearing, double time_step,
                                                 double duration, const AddedForce& added = {});
/// The same structure without isolation; the bearing has neither motion nor force.   @setup
[[nodiscard]] ResponseHistory fixed_base_response(const sim::StructureModel& structure,
                                                  const sim::GroundMotion& motion, double time_step,
                                                  double duration);

}  // namespace rths::loop
