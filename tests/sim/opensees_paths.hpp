// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::sim::test {

/// Where a bearing is, and how fast, at one instant.
struct Place {
  double displacement_long = 0, displacement_lat = 0;  ///< [m]
  double velocity_long = 0, velocity_lat = 0;          ///< [m/s]
  double load = 1, load_rate = 0;  ///< axial load over its mean [-], and its change [1/s]
};

/// A motion that a bearing is led along: one place for each step, from time 0.
struct Path {
  std::string name;
  double time_step = 0;  ///< [s]
  std::vector<Place> places;
};

/// Round in a circle, entered smoothly.
[[nodiscard]] Path circle(double amplitude, double time_step);
/// A rose of four leaves: through the centre in ever another direction.
[[nodiscard]] Path cloverleaf(double amplitude, double time_step);
/// A circle whose radius grows with time: every direction at every distance.
[[nodiscard]] Path spiral(double amplitude, double time_step);
/// What the example plant's isolation does in the example record, its larger peak made `amplitude`;
/// the load follows the vertical ground acceleration, in units of 1/g, three times.
[[nodiscard]] Path recorded(double amplitude, double time_step);

/// A cloverleaf under a load that swings between compression and tension, ever more: up to `most`
/// times its mean in both.
[[nodiscard]] Path pulled(double amplitude, double time_step, double most);

/// Two cloverleaves with a rest between them that is as long as eight.
[[nodiscard]] Path two_bursts(double amplitude, double time_step);

/// The first four of these in a long run (RTHS_LONG), cloverleaf and record in a short one.
[[nodiscard]] std::vector<Path> all_paths(double amplitude, double time_step);

}  // namespace rths::sim::test
