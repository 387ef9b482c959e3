// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "generic_client.hpp"
#include "identification.hpp"
#include "machine_axes.hpp"

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

/// The specimen of one element of a script: transforms between its degrees of freedom and the
/// machine's axes.
class Specimen {
 public:
  /// @param element  kept by reference
  /// @param step     time between targets [s]
  Specimen(const OpenSeesElement& element, double step);

  /// Commands along the machine's axes [m, m/s, m/s², rad, …], and the axial load [N].
  struct Command {
    Eigen::VectorXd displacement, velocity, acceleration;
    double load = 0;
  };
  /// Returns the commands of a trial state.
  [[nodiscard]] const Command& command_for(const Trial& trial);
  /// The commands of the last trial state.
  [[nodiscard]] const Command& command() const { return command_; }
  /// Returns the answer to the script, in its units: resisting forces and displacements; the
  /// trial's displacements if they are not measured.
  /// @param axes  measurement along the machine's axes [m, rad], [N, N·m]
  [[nodiscard]] Measurement measured(const Measurement& axes) const;

  /// Whether all matrices are known; else the test begins with probe() and measure().
  [[nodiscard]] bool is_identified() const { return !identification_; }
  /// Returns the next command of the identification.
  [[nodiscard]] const Command& probe();
  /// Takes the measurement of the last probe.
  /// @throws Error if it cannot be identified
  void measure(const Measurement& axes);
  /// Initial stiffness of each moved component [N/m, N·m/rad]; 0 before identification.
  [[nodiscard]] const Eigen::VectorXd& stiffness() const { return stiffness_; }
  /// In the script's units.   @pre is_identified()
  [[nodiscard]] const ElementMatrices& matrices() const { return matrices_; }

 private:
  void set_properties(const SpecimenIdentification::Properties& identified);
  [[nodiscard]] const Command& command_of(const ExperimentalElement::Motion& motion);

  const OpenSeesElement& element_;
  ExperimentalElement coordinates_;
  MachineAxes axes_;
  std::optional<SpecimenIdentification> identification_;
  Eigen::VectorXd stiffness_;
  ElementMatrices matrices_;
  /// Identified damping and mass, n × n in the script's units. OpenSees adds their forces, which
  /// the measured force already contains.
  Eigen::MatrixXd measured_damping_, measured_mass_;
  Trial trial_;
  Command command_;
};

}  // namespace rths::adapters
