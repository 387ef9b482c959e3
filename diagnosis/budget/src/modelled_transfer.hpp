// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "platen.hpp"
#include "sent_compensation.hpp"

namespace rths::budget {

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
