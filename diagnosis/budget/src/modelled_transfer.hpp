// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <rths/budget/closed_loop.hpp>
#include <rths/loop/transfer_system.hpp>

#include "platen.hpp"

namespace rths::budget {

/// The compensation as it ran: the references that it sent for a command.
class SentCompensation {
 public:
  explicit SentCompensation(const HybridTest& test);  ///< @setup
  /// One tick of the controller. @param force  of the specimen, as the controller knows it [N]
  [[nodiscard]] Eigen::Vector2d operator()(std::size_t tick, const loop::Command& command,
                                           const Eigen::Vector2d& force);

 private:
  [[nodiscard]] double reference_of(std::size_t axis, std::size_t tick,
                                    const loop::Command& command, double force);

  const HybridTest& test_;
  std::array<std::optional<controller::InverseLead>, 2> inverse_;
};

/// The transfer system of a closed loop, each part as simulated or as identified.
class ModelledTransfer final : public loop::TransferSystem {
 public:
  /// @param first_tick  of the machine: the noise and the vertical load of earlier ticks are
  /// skipped
  ModelledTransfer(const HybridTest& test, Parts identified, std::size_t first_tick);

  void send(std::size_t controller_tick, const loop::Command& command) override;
  void move(std::size_t found, const Eigen::VectorXd& forces) override;
  void measure(const Eigen::VectorXd& target, const loop::Command& last) override;
  [[nodiscard]] const Eigen::VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const Eigen::VectorXd& force() const override { return force_; }

 private:
  using Vector2d = Eigen::Vector2d;
  [[nodiscard]] loop::AxisMeasurement with_noise() const;

  const HybridTest& test_;
  const sim::Bearing& specimen_;
  const sim::TestMachine& machine_;
  SentCompensation compensation_;
  std::optional<platen::ServoTransfer> servo_;
  platen::IdealTransfer ideal_;
  platen::MachineOwnForce own_force_, known_force_;
  platen::Sensors sensors_;
  loop::ForceFeedback feedback_;
  bool measures_, knows_load_;
  std::size_t ticks_;                 ///< of the machine
  double load_ = 0;                   ///< on the machine [N]
  std::vector<platen::Motion> sent_;  ///< by tick of the controller
  platen::Platen motion_;
  loop::AxisMeasurement readings_;     ///< before the noise
  Vector2d exact_ = Vector2d::Zero();  ///< force of the specimen, exactly measured [N]
  Eigen::VectorXd displacement_ = Eigen::VectorXd::Zero(2), force_ = displacement_;
};

}  // namespace rths::budget
