// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include <rths/controller/path_sampler.hpp>

namespace rths::loop {

/// Command of the controller in one tick, one value per degree of freedom with a controlled
/// displacement. Its rates are along its path.
struct Command {
  Eigen::VectorXd displacement;  ///< [m, rad]
  Eigen::VectorXd velocity;      ///< [m/s, rad/s]
  Eigen::VectorXd acceleration;  ///< [m/s², rad/s²]
  controller::Pace pace;
};

/// What moves the specimen and measures its force: from the command to the force that is fed back.
/// Compensation, machine, specimen, sensors and correction of the force are parts of it.
class TransferSystem {
 public:
  TransferSystem() = default;
  TransferSystem(const TransferSystem&) = delete;
  TransferSystem& operator=(const TransferSystem&) = delete;
  virtual ~TransferSystem() = default;

  /// The controller sends a command at the end of one of its ticks.
  virtual void send(std::size_t controller_tick, const Command& command) = 0;
  /// One tick of the machine.
  /// @param found  commands sent before it; the last of them moves the specimen, 0: rest
  /// @param forces  targets of the degrees of freedom with a controlled force [N, N·m]
  virtual void move(std::size_t found, const Eigen::VectorXd& forces) = 0;
  /// The controller reads the measurements at the beginning of one of its ticks.
  /// @param target  of the integrator, as the controller knows it now [m, rad]
  /// @param last  command of the controller's last tick
  virtual void measure(const Eigen::VectorXd& target, const Command& last) = 0;
  [[nodiscard]] virtual const Eigen::VectorXd& displacement() const = 0;  ///< measured [m, rad]
  [[nodiscard]] virtual const Eigen::VectorXd& force() const = 0;  ///< that is fed back [N, N·m]
};

}  // namespace rths::loop
