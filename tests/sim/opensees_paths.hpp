// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::sim::test_support {

/// Displacement, velocity and load of a bearing at one instant.
struct PathPoint {
  double displacement_long = 0, displacement_lat = 0;  ///< [m]
  double velocity_long = 0, velocity_lat = 0;          ///< [m/s]
  double load = 1, load_rate = 0;  ///< axial load over its mean [-], and its rate [1/s]
};

/// A prescribed motion of a bearing: one point per step, from time 0.
struct Path {
  std::string name;
  double time_step = 0;  ///< [s]
  std::vector<PathPoint> points;
};

/// A circle with a smooth start.
[[nodiscard]] Path circle(double amplitude, double time_step);
/// A rose of four leaves, which passes the centre in changing directions.
[[nodiscard]] Path cloverleaf(double amplitude, double time_step);
/// A circle with growing radius: all directions at all distances.
[[nodiscard]] Path spiral(double amplitude, double time_step);
/// The example plant's base displacement in the example record, scaled so that its larger peak is
/// `amplitude`. The load varies by three times the vertical ground acceleration over g.
[[nodiscard]] Path recorded(double amplitude, double time_step);

/// A cloverleaf under a load that alternates between compression and tension with growing
/// amplitude, up to `most` times the mean load.
[[nodiscard]] Path pulled(double amplitude, double time_step, double most);

/// Two cloverleaves, with a rest as long as eight of them in between.
[[nodiscard]] Path two_bursts(double amplitude, double time_step);

/// The first four of these paths in a long run (RTHS_LONG); cloverleaf and record in a short run.
[[nodiscard]] std::vector<Path> all_paths(double amplitude, double time_step);

}  // namespace rths::sim::test_support
