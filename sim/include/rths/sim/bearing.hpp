// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/sim/composition.hpp>

namespace rths::sim {

/// A bearing: its physics, and the weight it carries.
struct Bearing {
  std::string title;
  std::vector<TermSettings> terms;
  double axial_load = 0;  ///< compression when nothing moves [N]
};

/// A bearing in motion. Allocates when built, never in `advance`.
class BearingRun {
 public:
  /// @param time_step  of `advance` [s]
  /// @throws Error as Composition does   @setup
  BearingRun(const Bearing& bearing, double time_step);

  /// Moves the bearing for one time step and returns its restoring force, long and lat [N].
  /// @param displacement,velocity  at the end of the step: long, lat [m], [m/s]
  /// @param axial_load  compression [N]   @realtime
  Eigen::Vector2d advance(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                          double axial_load) RTHS_REALTIME;

 private:
  Composition composition_;
  std::vector<double> state_;
  double time_ = 0;
};

/// Stiffness of the larger axis when nothing has moved yet [N/m].   @setup
[[nodiscard]] double initial_stiffness(const Bearing& bearing);

/// Reads a bearing's table: `title`, and its terms as `read_terms` does.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] Bearing read_bearing(const Config& table, double axial_load);

}  // namespace rths::sim
