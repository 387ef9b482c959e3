// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include <rths/adapters/opensees_element.hpp>

#include "experimental_element.hpp"
#include "generic_client.hpp"
#include "identification.hpp"
#include "machine_axes.hpp"

namespace rths::adapters {

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
