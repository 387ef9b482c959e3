// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

namespace rths::adapters {

/// OpenFresco's set-up: transforms between the moved components of a specimen and the machine's
/// axes. The axes are the components themselves, possibly with opposite sign, or actuators between
/// two pins, with exact lengths at any displacement and rotation of the platen.
///
///     l_k = |R·(P_k) + u − F_k| − |P_k − F_k|    J = ∂l/∂d    q = Jᵀ·f
class MachineAxes {
 public:
  /// @param element  kept by reference
  explicit MachineAxes(const OpenSeesElement& element);

  [[nodiscard]] Eigen::Index axes() const { return axes_; }
  /// Sets the position of the moved components, at which the other functions are evaluated.
  /// @returns the axes' displacements
  Eigen::VectorXd set_position(const Eigen::VectorXd& moved);
  /// Rates along the axes. Accelerations of actuators omit the contribution of their rotation,
  /// because the controller uses them only as a feed-forward value.
  [[nodiscard]] Eigen::VectorXd rate(const Eigen::VectorXd& moved) const {
    return jacobian_ * moved;
  }
  /// Forces of the moved components, from forces along the axes.
  [[nodiscard]] Eigen::VectorXd force(const Eigen::VectorXd& axes) const {
    return jacobian_.transpose() * axes;
  }
  /// Displacements of the moved components from those of the axes, linearised at rest.
  [[nodiscard]] Eigen::VectorXd displacement(const Eigen::VectorXd& axes) const;

 private:
  [[nodiscard]] Eigen::Matrix<double, kComponents, 1> platen(const Eigen::VectorXd& moved) const;

  const OpenSeesElement& element_;
  Eigen::Index axes_;
  Eigen::MatrixXd jacobian_;  ///< axes × moved
  Eigen::MatrixXd inverse_;   ///< at rest
};

}  // namespace rths::adapters
