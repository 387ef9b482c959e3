// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "generic_client.hpp"

namespace rths::adapters {

/// Between the degrees of freedom of a script and what of a specimen is moved: components of a
/// bearing, or the degrees of freedom themselves. SI on the specimen's side, the script's units on
/// the other.
///
///     d_b = B·d    p = Bᵀ·q + p_PΔ    K = Bᵀ·K_b·B
class ExperimentalElement {
 public:
  /// @param element  kept by reference
  explicit ExperimentalElement(const OpenSeesElement& element);

  /// Deformation and rates of what is moved [m, m/s, m/s², rad, …].
  struct Motion {
    Eigen::VectorXd displacement, velocity, acceleration;
  };
  /// Takes a trial state in. @returns what it means for what is moved
  const Motion& place(const Trial& trial);
  /// What the machine is to apply along the axial component, if that is not moved but loaded [N].
  [[nodiscard]] double axial_force() const { return axial_force_; }
  /// Resisting forces, but for viscous ones of springs: OpenSees adds these itself, at the script's
  /// degrees of freedom, in the state that was placed last.
  /// @param moved  restoring forces of what is moved [N, N·m]
  [[nodiscard]] Eigen::VectorXd resisting(const Eigen::VectorXd& moved) const;
  /// Displacements of an element in the script's own coordinates, in its units.
  [[nodiscard]] Eigen::VectorXd in_script(const Eigen::VectorXd& moved) const {
    return moved.cwiseQuotient(to_si_);
  }
  /// A matrix of what is moved, with its springs' part, at the script's degrees of freedom.
  [[nodiscard]] ElementMatrices matrices(const Eigen::MatrixXd& stiffness,
                                         const Eigen::MatrixXd& damping,
                                         const Eigen::MatrixXd& mass) const;

 private:
  [[nodiscard]] bool is_moved(std::size_t component) const;
  [[nodiscard]] Eigen::VectorXd p_delta_moments(double axial_force) const;

  const OpenSeesElement& element_;
  Eigen::VectorXd to_si_, to_script_;  ///< of displacements; of forces
  Eigen::MatrixXd local_;              ///< 12 × n: local displacements of both nodes
  Eigen::MatrixXd compatibility_;      ///< B
  Eigen::MatrixXd moved_;              ///< rows of B that are moved
  Eigen::VectorXd local_displacement_;
  Eigen::VectorXd springs_force_;  ///< elastic, of components that are not moved
  double axial_force_ = 0;
  Motion motion_;
};

}  // namespace rths::adapters
