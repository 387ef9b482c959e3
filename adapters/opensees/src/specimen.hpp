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

/// What stands for one element of a script: from its degrees of freedom to the machine's axes and
/// back.
class Specimen {
 public:
  /// @param element  kept by reference
  /// @param step     from target to target [s]
  Specimen(const OpenSeesElement& element, double step);

  /// Along the machine's axes [m, m/s, m/s², rad, …], and the force to load with [N].
  struct Command {
    Eigen::VectorXd displacement, velocity, acceleration;
    double load = 0;
  };
  /// What a trial state of the script commands.
  [[nodiscard]] const Command& place(const Trial& trial);
  /// What the script is answered, in its units: resisting forces, and where the specimen stands;
  /// where it was told to be if nobody measures that.
  /// @param axes  along the machine's axes [m, rad], [N, N·m]
  [[nodiscard]] Measured measured(const Measured& axes) const;

  /// Before the test: whether it has to be shaken to be known, how, and what came of it.
  [[nodiscard]] bool is_known() const { return !identification_; }
  [[nodiscard]] const Command& probe();
  /// @throws Error if it cannot be identified
  void measure(const Measured& axes);
  /// Initial stiffness of what is moved, each by itself [N/m, N·m/rad]; 0 if it is not known yet.
  [[nodiscard]] const Eigen::VectorXd& stiffness() const { return stiffness_; }
  /// In the script's units.   @pre is_known()
  [[nodiscard]] const ElementMatrices& matrices() const { return matrices_; }

 private:
  void settle(const Identification::Found& found);
  [[nodiscard]] const Command& command_of(const ExperimentalElement::Motion& motion);

  const OpenSeesElement& element_;
  ExperimentalElement coordinates_;
  MachineAxes axes_;
  std::optional<Identification> identification_;
  Eigen::VectorXd stiffness_;
  ElementMatrices matrices_;
  /// Of damping and mass that were identified, n × n in the script's units: the measured force has
  /// their part already, which OpenSees will add.
  Eigen::MatrixXd measured_damping_, measured_mass_;
  Trial trial_;
  Command command_;
};

}  // namespace rths::adapters
