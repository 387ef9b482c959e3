// SPDX-License-Identifier: Apache-2.0
#include "floor_monitors.hpp"

#include <fmt/format.h>

#include <rths/core/axis.hpp>

namespace rths::plant {

std::vector<sim::MonitoredQuantity> monitors_of(std::size_t floors) {
  std::vector<sim::MonitoredQuantity> monitors;
  const auto add = [&](const std::string& place) {
    for (const Axis axis : kTranslations)
      monitors.push_back({place + ".accel." + name_of(axis), "m/s2"});
  };
  add("ground");
  for (std::size_t i = 1; i <= floors; ++i) add(fmt::format("floor.{}", i));
  return monitors;
}

void write_monitors(const Eigen::Vector3d& ground, const VectorXd& floors,
                    std::span<double> values) noexcept {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto at = static_cast<Index>(i);
    values[i] = ground[at % 3] + (at < 3 ? 0 : floors[at - 3]);
  }
}

Eigen::Vector3d ground_at(const sim::GroundMotion& motion, double time) noexcept {
  const Eigen::Vector2d level = motion.at(time);
  return {level[0], level[1], motion.vertical_at(time)};
}

}  // namespace rths::plant
