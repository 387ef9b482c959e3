// SPDX-License-Identifier: Apache-2.0
#include "machine_axes.hpp"

#include <cmath>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

#include "eigen_conversion.hpp"

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Components = Eigen::Matrix<double, kComponents, 1>;

Matrix3d cross_matrix(const Vector3d& v) {
  Matrix3d m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

// Rotation matrix of a rotation vector (Rodrigues).
Matrix3d turned_by(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd{angle, rotation / angle}.toRotationMatrix();
}

// Maps a rotation vector's rate to angular velocity: sin θ/θ·I + (1 − cos θ)/θ²·[θ]× + (θ − sin
// θ)/θ³·θθᵀ.
Matrix3d spin_of(const Vector3d& rotation) {
  const double angle = rotation.norm();
  if (angle < 1e-6) return Matrix3d::Identity() + cross_matrix(rotation) / 2;
  const double square = angle * angle;
  return std::sin(angle) / angle * Matrix3d::Identity() +
         (1 - std::cos(angle)) / square * cross_matrix(rotation) +
         (angle - std::sin(angle)) / (square * angle) * rotation * rotation.transpose();
}

// Vector of an actuator, from its fixed pin to its pin on the displaced platen.
Vector3d reach(const ActuatorAxis& actuator, const Components& d) {
  return turned_by(d.tail<3>()) * to_eigen(actuator.platen_pin) + d.head<3>() -
         to_eigen(actuator.fixed_pin);
}

// Derivative of an actuator's length with respect to each component.
Components gradient(const ActuatorAxis& actuator, const Components& d) {
  const Vector3d along = reach(actuator, d).normalized();
  const Vector3d arm = turned_by(d.tail<3>()) * to_eigen(actuator.platen_pin);
  Components gradient;
  gradient << along, spin_of(d.tail<3>()).transpose() * arm.cross(along);
  return gradient;
}

}  // namespace

MachineAxes::MachineAxes(const OpenSeesElement& element)
    : element_{element},
      axes_{element.actuators.empty() ? std::ssize(element.axes) : std::ssize(element.actuators)} {
  const Index moved = std::ssize(element.axes);
  jacobian_ = MatrixXd::Zero(axes_, moved);
  if (element.actuators.empty())
    for (Index i = 0; i < moved; ++i)
      jacobian_(i, i) = element.axes[static_cast<std::size_t>(i)].direction;
  static_cast<void>(set_position(VectorXd::Zero(moved)));
  const maths::MinimumNormSolver decomposition{jacobian_};
  if (decomposition.rank() < moved)
    throw Error{
        fmt::format("element '{}': its actuators control {} of the {} components that they move",
                    element.name, decomposition.rank(), moved)};
  inverse_ = decomposition.pseudo_inverse();
}

Components MachineAxes::platen(const VectorXd& moved) const {
  Components d = Components::Zero();
  for (std::size_t i = 0; i < element_.axes.size(); ++i)
    d[static_cast<Index>(element_.axes[i].index)] = moved[static_cast<Index>(i)];
  return d;
}

VectorXd MachineAxes::set_position(const VectorXd& moved) {
  if (element_.actuators.empty()) return jacobian_ * moved;
  const Components d = platen(moved);
  VectorXd elongation{axes_};
  for (Index k = 0; k < axes_; ++k) {
    const auto& actuator = element_.actuators[static_cast<std::size_t>(k)];
    elongation[k] = reach(actuator, d).norm() -
                    (to_eigen(actuator.platen_pin) - to_eigen(actuator.fixed_pin)).norm();
    const Components slope = gradient(actuator, d);
    for (std::size_t i = 0; i < element_.axes.size(); ++i)
      jacobian_(k, static_cast<Index>(i)) = slope[static_cast<Index>(element_.axes[i].index)];
  }
  return elongation;
}

VectorXd MachineAxes::displacement(const VectorXd& axes) const { return inverse_ * axes; }

}  // namespace rths::adapters
