// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/budget/closed_loop.hpp>
#include <rths/loop/transfer_system.hpp>

namespace rths::budget {

/// The transfer system of a closed loop, each part as simulated or as identified.
class ModelledTransfer final : public loop::TransferSystem {
 public:
  /// @param first_tick  of the machine: the noise and the vertical load of earlier ticks are
  /// skipped
  ModelledTransfer(const HybridTest& test, Parts identified, std::size_t first_tick);
  ~ModelledTransfer() override;

  void send(std::size_t controller_tick, const loop::Command& command) override;
  void move(std::size_t found, const Eigen::VectorXd& forces) override;
  void measure(const Eigen::VectorXd& target, const loop::Command& last) override;
  [[nodiscard]] const Eigen::VectorXd& displacement() const override;
  [[nodiscard]] const Eigen::VectorXd& force() const override;

 private:
  struct Model;
  std::unique_ptr<Model> model_;
};

}  // namespace rths::budget
