// SPDX-License-Identifier: Apache-2.0
#include "opensees_paths.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/constants.hpp>
#include <rths/loop/numerical_response.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/motion_file.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"
#include "support/long_run.hpp"

namespace rths::sim::test_support {
namespace {

constexpr double kOrbitDuration = 9;     // [s]
constexpr double kOrbitFrequency = 0.5;  // [Hz]
constexpr double kEntry = 2;             // growth time of an orbit [s]
constexpr double kLoadPerGravity = 3;
constexpr double kLeastLoadRatio = 0.2;  // avoids uplift, which other paths test

double record_duration() { return test::is_long() ? 25 : 10; }  // [s]

// Smooth growth from 0 to 1.
double entry(double time) {
  const double fraction = std::min(time / kEntry, 1.0);
  return fraction * fraction * (3 - 2 * fraction);
}

// Samples `orbit(t, point)`. Velocities are central differences over 20 µs with an error, O(h²),
// below 1e-8 of the velocity.
template <class Orbit>
Path orbit_path(const std::string& name, double time_step, Orbit orbit) {
  constexpr double kHalf = 1e-5;
  Path path{name, time_step, {}};
  const auto steps = static_cast<int>(kOrbitDuration / time_step);
  for (int i = 0; i <= steps; ++i) {
    const double t = i * time_step;
    PathPoint point, before, behind;
    orbit(t, point);
    orbit(std::max(t - kHalf, 0.0), before);
    orbit(t + kHalf, behind);
    const double width = t + kHalf - std::max(t - kHalf, 0.0);
    point.velocity_long = (behind.displacement_long - before.displacement_long) / width;
    point.velocity_lat = (behind.displacement_lat - before.displacement_lat) / width;
    path.points.push_back(point);
  }
  return path;
}

// Rates of all points but the first and last, by central differences.
void differentiate(Path& path) {
  auto& points = path.points;
  for (std::size_t i = 1; i + 1 < points.size(); ++i) {
    const PathPoint &before = points[i - 1], &behind = points[i + 1];
    const double width = 2 * path.time_step;
    points[i].velocity_long = (behind.displacement_long - before.displacement_long) / width;
    points[i].velocity_lat = (behind.displacement_lat - before.displacement_lat) / width;
    points[i].load_rate = (behind.load - before.load) / width;
  }
}

}  // namespace

Path circle(double amplitude, double time_step) {
  return orbit_path("circle", time_step, [&](double t, PathPoint& point) {
    const double angle = 2 * std::numbers::pi * kOrbitFrequency * t;
    point.displacement_long = amplitude * entry(t) * std::cos(angle);
    point.displacement_lat = amplitude * entry(t) * std::sin(angle);
  });
}

Path cloverleaf(double amplitude, double time_step) {
  return orbit_path("cloverleaf", time_step, [&](double t, PathPoint& point) {
    const double angle = std::numbers::pi * kOrbitFrequency * t;
    const double radius = amplitude * entry(t) * std::sin(2 * angle);
    point.displacement_long = radius * std::cos(angle);
    point.displacement_lat = radius * std::sin(angle);
  });
}

Path spiral(double amplitude, double time_step) {
  return orbit_path("spiral", time_step, [&](double t, PathPoint& point) {
    const double angle = 2 * std::numbers::pi * kOrbitFrequency * t;
    const double radius = amplitude * t / kOrbitDuration;
    point.displacement_long = radius * std::cos(angle);
    point.displacement_lat = radius * std::sin(angle);
  });
}

Path recorded(double amplitude, double time_step) {
  const auto file =
      test::source_tree() / "examples/records" / "petrolia_1992_riodell_freefield.csv";
  GroundMotion motion;
  const auto h1 = read_column(file, 1), h2 = read_column(file, 2), v = read_column(file, 3);
  motion.time_step = h1.time_step;
  for (const double a : h1.values) motion.long_acceleration.push_back(a * kStandardGravity);
  for (const double a : h2.values) motion.lat_acceleration.push_back(a * kStandardGravity);
  const auto response = loop::numerical_response(
      StickModel{example_plant()}, motion, test::plain_lead_rubber(), time_step, record_duration());
  double peak = 0;
  for (std::size_t i = 0; i < response.displacement_long.size(); ++i)
    peak = std::max(peak, std::hypot(response.displacement_long[i], response.displacement_lat[i]));
  const double scale = amplitude / peak;
  const GroundMotion vertical{v.time_step, v.values, v.values};
  Path path{"record", time_step, {PathPoint{}}};
  for (std::size_t i = 0; i < response.displacement_long.size(); ++i) {
    PathPoint point;
    point.displacement_long = scale * response.displacement_long[i];
    point.displacement_lat = scale * response.displacement_lat[i];
    const double acceleration = vertical.at(static_cast<double>(i + 1) * time_step)[0];
    point.load = std::max(1 + kLoadPerGravity * acceleration, kLeastLoadRatio);
    path.points.push_back(point);
  }
  differentiate(path);
  return path;
}

Path pulled(double amplitude, double time_step, double most) {
  constexpr double kSwing = 1.3;  // [Hz]
  Path path = cloverleaf(amplitude, time_step);
  path.name = "pulled";
  for (std::size_t i = 0; i < path.points.size(); ++i) {
    const double t = static_cast<double>(i) * time_step;
    path.points[i].load = most * t / kOrbitDuration * std::sin(2 * std::numbers::pi * kSwing * t);
  }
  differentiate(path);
  return path;
}

Path two_bursts(double amplitude, double time_step) {
  constexpr std::size_t kRest = 8;
  // The ninth second ends at the centre, but in motion.
  Path path = cloverleaf(amplitude, time_step);
  path.name = "two bursts";
  const auto burst = path.points;
  path.points.insert(path.points.end(), kRest * burst.size(), PathPoint{});
  path.points.insert(path.points.end(), burst.begin(), burst.end());
  return path;
}

std::vector<Path> all_paths(double amplitude, double time_step) {
  std::vector<Path> paths{cloverleaf(amplitude, time_step), recorded(amplitude, time_step)};
  if (test::is_long()) {
    paths.push_back(circle(amplitude, time_step));
    paths.push_back(spiral(amplitude, time_step));
  }
  return paths;
}

}  // namespace rths::sim::test_support
