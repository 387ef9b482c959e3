// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/ground_motion.hpp>

#include <algorithm>

#include <rths/core/constants.hpp>
#include <rths/sim/motion_file.hpp>

namespace rths::sim {
namespace {

double between(const std::vector<double>& values, double position) noexcept {
  if (!(position >= 0) || position > static_cast<double>(values.size()) - 1) return 0;
  const auto i = std::min(static_cast<std::size_t>(position), values.size() - 2);
  const double fraction = position - static_cast<double>(i);
  return (1 - fraction) * values[i] + fraction * values[i + 1];
}

}  // namespace

Eigen::Vector2d GroundMotion::at(double time) const noexcept {
  const double position = time / time_step;
  return {between(long_acceleration, position), between(lat_acceleration, position)};
}

GroundMotion GroundMotion::along(const std::array<bool, 2>& tested) const {
  GroundMotion motion = *this;
  if (!tested[0]) std::ranges::fill(motion.long_acceleration, 0);
  if (!tested[1]) std::ranges::fill(motion.lat_acceleration, 0);
  return motion;
}

double GroundMotion::vertical_at(double time) const noexcept {
  return vert_acceleration.empty() ? 0 : between(vert_acceleration, time / time_step);
}

GroundMotion read_motion(const std::filesystem::path& file, const std::array<int, 3>& columns,
                         double scale) {
  const MotionFile read = read_motion_file(file);
  GroundMotion motion;
  motion.time_step = read.time_step;
  const auto component = [&](int column) {
    auto values = acceleration_in_g(read, column);
    for (double& value : values) value *= scale * kStandardGravity;
    return values;
  };
  motion.long_acceleration = component(columns[0]);
  motion.lat_acceleration = component(columns[1]);
  motion.vert_acceleration = component(columns[2]);
  return motion;
}

}  // namespace rths::sim
