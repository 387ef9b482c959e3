// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/core/realtime.hpp>

namespace rths::sim::machine {

/// A force and a moment about the platen's centre of mass, or a linear and an angular rate: long,
/// lat, vert, roll, pitch, yaw.
using Vector6 = Eigen::Matrix<double, 6, 1>;

/// Position and orientation of the platen. The floor's axes are long, lat and up; the origin is the
/// centre of mass at mid-stroke.
struct Pose {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< of the centre of mass [m]
  Eigen::Vector3d angles = Eigen::Vector3d::Zero();    ///< roll, pitch, yaw [rad]

  /// R = R_z(yaw) R_y(pitch) R_x(roll): from the platen's axes to the floor's.   @realtime
  [[nodiscard]] Eigen::Matrix3d rotation() const RTHS_REALTIME;
};

/// Rates of roll, pitch and yaw from the angular velocity in the platen's axes [rad/s]. Singular
/// at a pitch of ±90°.   @realtime
[[nodiscard]] Eigen::Vector3d angle_rates(const Eigen::Vector3d& angles,
                                          const Eigen::Vector3d& angular_velocity) RTHS_REALTIME;

/// A support of the platen with one coordinate s(pose): its value, and its rate per motion of the
/// platen, ṡ = jacobian · (v, ω), both in the floor's axes. By virtual work, a force f along s acts
/// on the platen with f · jacobian.
struct Coordinate {
  double value = 0;  ///< [m]
  Vector6 jacobian = Vector6::Zero();
};

/// The length of an actuator with a swivel at either end: s = |c + R p − b|.
/// @param base      b, in the floor's axes [m]
/// @param arm       R p, from the centre of mass to the platen's swivel, in the floor's axes [m]
/// @param position  c, of the centre of mass [m]   @realtime
[[nodiscard]] Coordinate actuator_length(const Eigen::Vector3d& base, const Eigen::Vector3d& arm,
                                         const Eigen::Vector3d& position) RTHS_REALTIME;

/// The height of a bearing pad on a vertical actuator. The pad tilts and slides under the platen's
/// plane bottom, so it transmits only a force normal to it:
///     s = q_z − (n_x (x − q_x) + n_y (y − q_y)) / n_z
///     q = c − R (0, 0, depth),   n = R (0, 0, 1)
/// @param foot   x, y of the actuator in the floor's axes [m]
/// @param depth  of the bottom below the centre of mass [m]   @realtime
[[nodiscard]] Coordinate pad_height(const Eigen::Vector2d& foot, double depth,
                                    const Eigen::Matrix3d& rotation,
                                    const Eigen::Vector3d& position) RTHS_REALTIME;

}  // namespace rths::sim::machine
