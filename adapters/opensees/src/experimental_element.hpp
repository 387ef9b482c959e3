// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "generic_client.hpp"

namespace rths::adapters {

/// Transforms between a script's degrees of freedom and the moved components of a specimen: those
/// of a bearing, or the degrees of freedom themselves. The specimen's side is in SI, the other side
/// in the script's units.
///
///     d_b = B·d    p = Bᵀ·q + p_PΔ    K = Bᵀ·K_b·B
class ExperimentalElement {
 public:
  /// @param element  kept by reference
  explicit ExperimentalElement(const OpenSeesElement& element);

  /// Displacement and rates of the moved components [m, m/s, m/s², rad, …].
  struct Motion {
    Eigen::VectorXd displacement, velocity, acceleration;
  };
  /// Applies a trial state. @returns the motion of the moved components
  const Motion& apply(const Trial& trial);
  /// Force that the machine applies along the axial component, if that is loaded, not moved [N].
  [[nodiscard]] double axial_force() const { return axial_force_; }
  /// Returns resisting forces at the script's degrees of freedom, for the last applied state.
  /// Excludes viscous forces of the springs, which OpenSees adds itself.
  /// @param moved  restoring forces of the moved components [N, N·m]
  [[nodiscard]] Eigen::VectorXd resisting_forces(const Eigen::VectorXd& moved) const;
  /// Displacements at the script's degrees of freedom, of an element without bearing, in its units.
  [[nodiscard]] Eigen::VectorXd in_script(const Eigen::VectorXd& moved) const {
    return moved.cwiseQuotient(to_si_);
  }
  /// Transforms matrices of the moved components to the script's degrees of freedom and adds the
  /// springs.
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
  Eigen::MatrixXd moved_;              ///< rows of B of the moved components
  Eigen::VectorXd local_displacement_;
  Eigen::VectorXd springs_force_;  ///< elastic, of components that are not moved
  double axial_force_ = 0;
  Motion motion_;
};

}  // namespace rths::adapters
