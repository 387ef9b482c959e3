// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

namespace rths::adapters {

/// OpenFresco's set-up: between what of a specimen is moved and the axes of the machine that moves
/// it: the axes themselves, perhaps counted the other way, or actuators between two pins each,
/// whose lengths follow the platen at any displacement and rotation.
///
///     l_k = |R·(P_k) + u − F_k| − |P_k − F_k|    J = ∂l/∂d    q = Jᵀ·f
class MachineAxes {
 public:
  /// @param element  kept by reference
  explicit MachineAxes(const OpenSeesElement& element);

  [[nodiscard]] Eigen::Index axes() const { return axes_; }
  /// @returns the axes' displacements when what is moved is there. Others go by this place, too
  Eigen::VectorXd place(const Eigen::VectorXd& moved);
  /// Rates along the axes. Of actuators, without the part of the acceleration that their turning
  /// adds: what a controller is told is a hint to it.
  [[nodiscard]] Eigen::VectorXd rate(const Eigen::VectorXd& moved) const {
    return jacobian_ * moved;
  }
  /// Forces of what is moved, of those along the axes.
  [[nodiscard]] Eigen::VectorXd force(const Eigen::VectorXd& axes) const {
    return jacobian_.transpose() * axes;
  }
  /// Where what is moved stands, near its place at rest.
  [[nodiscard]] Eigen::VectorXd displacement(const Eigen::VectorXd& axes) const;

 private:
  [[nodiscard]] Eigen::Matrix<double, kComponents, 1> platen(const Eigen::VectorXd& moved) const;

  const OpenSeesElement& element_;
  Eigen::Index axes_;
  Eigen::MatrixXd jacobian_;  ///< axes × moved
  Eigen::MatrixXd inverse_;   ///< at rest
};

}  // namespace rths::adapters
