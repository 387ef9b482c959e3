// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/machine/geometry.hpp>

#include <cmath>

#include <Eigen/Geometry>

namespace rths::sim::machine {

using Eigen::Vector3d;

Eigen::Matrix3d Pose::rotation() const noexcept {
  const double sr = std::sin(angles[0]), cr = std::cos(angles[0]);
  const double sp = std::sin(angles[1]), cp = std::cos(angles[1]);
  const double sy = std::sin(angles[2]), cy = std::cos(angles[2]);
  Eigen::Matrix3d R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
      sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
      -sp, cp * sr, cp * cr;
  return R;
}

Vector3d angle_rates(const Vector3d& angles, const Vector3d& w) noexcept {
  const double sr = std::sin(angles[0]), cr = std::cos(angles[0]);
  const double around = sr * w[1] + cr * w[2];
  return {w[0] + std::tan(angles[1]) * around, cr * w[1] - sr * w[2], around / std::cos(angles[1])};
}

Coordinate actuator_length(const Vector3d& base, const Vector3d& arm,
                           const Vector3d& position) noexcept {
  const Vector3d along = position + arm - base;
  Coordinate c;
  c.value = along.norm();
  const Vector3d direction = along / c.value;
  c.jacobian.head<3>() = direction;
  c.jacobian.tail<3>() = arm.cross(direction);
  return c;
}

Coordinate pad_height(const Eigen::Vector2d& foot, double depth, const Eigen::Matrix3d& rotation,
                      const Vector3d& position) noexcept {
  const Vector3d normal = rotation.col(2);
  const Vector3d bottom = position - depth * normal;
  const Eigen::Vector2d slope = normal.head<2>() / normal[2];
  Coordinate c;
  c.value = bottom[2] - slope.dot(foot - bottom.head<2>());
  const Vector3d contact = Vector3d{foot[0], foot[1], c.value} - position;
  const Vector3d force = normal / normal[2];  // on the platen, per unit of the actuator's force
  c.jacobian.head<3>() = force;
  c.jacobian.tail<3>() = contact.cross(force);
  return c;
}

}  // namespace rths::sim::machine
