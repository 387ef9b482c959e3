// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/sim/composition.hpp>

namespace rths::sim {

/// Version of the format of a bearing's file, its key `bearing`. Bumped when a file that was right
/// before would mean something else, or no longer load.
inline constexpr int kBearingFormat = 1;

/// A bearing: its physics, and the weight it carries.
struct Bearing {
  std::string title;
  std::vector<TermSettings> terms;
  double axial_load = 0;   ///< compression when nothing moves [N]
  double temperature = 0;  ///< of the surroundings above that of reference [°C]
};

/// A bearing in motion. Allocates when built, never in `advance`.
class BearingRun {
 public:
  /// @param time_step  of `advance` [s]
  /// @throws Error as Composition does, and for terms that need what is not given here: an
  ///         acceleration, a vertical displacement   @setup
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

/// Refuses terms that take the axial load, or nothing at all, from a vertical displacement, where
/// the load itself is given.   @throws Error naming the term   @setup
void require_given_load(const Bearing& bearing);

/// Largest stiffness of either axis [N/m]: of a first move of 1 nm, far below every yield
/// displacement, and of each 50 µm of a slow cycle of ±0.3 m after it, which closes gaps and meets
/// stops. Only what resists is moved: play or delay before it and sensors after it are left out.
/// 0 if nothing resists, as with a dashpot alone.   @setup
[[nodiscard]] double largest_stiffness(const Bearing& bearing);

/// The stiffness that an implicit integration may rest on [N/m]: `largest_stiffness`.
/// @throws Error if it is not positive   @setup
[[nodiscard]] double initial_stiffness(const Bearing& bearing);

/// Reads a bearing's table: `title`, `temperature_above_reference_K`, and its terms as `read_terms`
/// does. Keys that the caller asked for before are not unknown.
/// @throws Error with the place of the first wrong key or value, or if there is no term   @setup
[[nodiscard]] Bearing read_bearing(const Config& table, double axial_load);

}  // namespace rths::sim
