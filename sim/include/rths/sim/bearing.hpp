// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/sim/composition.hpp>

namespace rths::sim {

/// Format version of a bearing's file, its key `bearing`. Bump it when an existing file would
/// change its meaning or no longer load.
inline constexpr int kBearingFormat = 1;

/// A bearing: its physics and the weight it carries.
struct Bearing {
  std::string title;
  std::vector<TermSettings> terms;
  double axial_load = 0;   ///< compression at rest [N]
  double temperature = 0;  ///< ambient, above the reference [°C]
};

/// A bearing in motion. Allocates when built, never in `advance`.
class BearingRun {
 public:
  /// @param time_step  of `advance` [s]
  /// @throws Error as Composition does, and for terms that need an acceleration or a vertical
  ///         displacement, which a bearing does not receive   @setup
  BearingRun(const Bearing& bearing, double time_step);

  /// Moves the bearing for one time step and returns its restoring force, long and lat [N].
  /// @param displacement,velocity  at the end of the step: long, lat [m], [m/s]
  /// @param axial_load  compression [N]   @realtime
  Eigen::Vector2d advance(const Eigen::Vector2d& displacement, const Eigen::Vector2d& velocity,
                          double axial_load) RTHS_REALTIME;

 private:
  Composition composition_;
  std::vector<double> state_;
  double temperature_;
  double time_ = 0;
};

/// Refuses terms that need a vertical displacement, for runs that prescribe the axial load.
/// @throws Error naming the term   @setup
void require_given_load(const Bearing& bearing);

/// Largest stiffness of either axis [N/m], from a probe: a first move of 1 nm, far below every
/// yield displacement, then a slow cycle of ±0.3 m in moves of 50 µm, which closes gaps and reaches
/// stops. Actuator, motion and sensor terms are left out, so play and delay do not soften the
/// probe. 0 if no term has stiffness, as with a dashpot alone.   @setup
[[nodiscard]] double largest_stiffness(const Bearing& bearing);

/// The initial stiffness for an implicit integration [N/m]: `largest_stiffness`.
/// @throws Error if it is not positive   @setup
[[nodiscard]] double initial_stiffness(const Bearing& bearing);

/// Reads a bearing's table: `title`, `temperature_above_reference_K`, and its terms as `read_terms`
/// does. Keys that the caller read before do not count as unknown.
/// @throws Error with the place of the first wrong key or value, or if there is no term   @setup
[[nodiscard]] Bearing read_bearing(const Config& table, double axial_load);

}  // namespace rths::sim
