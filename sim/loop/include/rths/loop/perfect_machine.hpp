// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/loop/transfer_system.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::loop {

/// A transfer system without any error: the specimen is a bearing's model that reaches each command
/// in the next tick of the machine. Commands are long and lat, the controlled force is its
/// compression on top of the axial load.
class PerfectMachine final : public TransferSystem {
 public:
  /// @param period  of the machine, model time [s]
  /// @param pieces  in which the specimen moves straight from command to command, ≥ 1. In one piece
  /// it has the velocity of the command, in several that of the line.
  /// @throws Error as BearingRun does   @setup
  PerfectMachine(const sim::Bearing& bearing, double period, int pieces = 1);

  void send(std::size_t controller_tick, const Command& command) override;
  void move(std::size_t found, const Eigen::VectorXd& forces) override;
  void measure(const Eigen::VectorXd& /*target*/, const Command& /*last*/) override {}
  [[nodiscard]] const Eigen::VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const override { return force_; }

 private:
  sim::BearingRun specimen_;
  double axial_load_, period_;
  int pieces_;
  Eigen::Vector2d to_ = Eigen::Vector2d::Zero(), velocity_ = Eigen::Vector2d::Zero();
  Eigen::VectorXd displacement_ = Eigen::VectorXd::Zero(2), force_ = Eigen::VectorXd::Zero(2);
};

}  // namespace rths::loop
