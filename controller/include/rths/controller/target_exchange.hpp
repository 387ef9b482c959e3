// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

#include <rths/controller/predictor_corrector.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// The controller's side of the handshake with the integrator, as flags on the ring.
///
/// A number above 0 that newTarget had not before is a new target: for one substep `new_target` is
/// true, switchPC is raised and atTarget is lowered. When newTarget falls to 0, switchPC is
/// lowered. When the command has reached the target (or `delay` substeps later, so that the
/// specimen arrives), the feedbacks are sampled and held, and atTarget is raised to the target's
/// number. So an integrator need not wait for switchPC if its targets have two numbers in turn.
/// newTarget below 0 stops the test ten substeps later.
///
/// Before the first target, atTarget is raised and the feedbacks are live. Otherwise an integrator
/// that waits for atTarget before its first step would wait forever.
class TargetExchange {
 public:
  /// @param delay_substeps  per axis: substeps between the command's arrival and the sample, ≥ 0
  /// @param settings        of the predictor-corrector that this exchange serves
  /// @throws Error if a delay is refused by `judge_delay`   @setup
  TargetExchange(std::vector<int> delay_substeps, const PredictorCorrectorSettings& settings);

  /// Call before the predictor-corrector's substep. @param new_target_word  as on the ring
  /// @returns true if this substep has a new target   @realtime
  bool begin(double new_target_word) RTHS_REALTIME;
  /// Call after the predictor-corrector's substep. Samples the axes that are due.
  /// @param displacement, force  measured, axes × 1 [m], [N]   @realtime
  void end(const PredictorCorrector& command, const Eigen::VectorXd& displacement,
           const Eigen::VectorXd& force) RTHS_REALTIME;

  [[nodiscard]] bool switch_pc() const { return switch_pc_; }
  [[nodiscard]] bool at_target() const { return at_target_; }
  /// Of the newest target; 1 before the first.
  [[nodiscard]] double number() const { return number_; }
  [[nodiscard]] bool stopped() const { return stop_countdown_ == 0; }
  [[nodiscard]] const Eigen::VectorXd& held_displacement() const { return held_displacement_; }
  [[nodiscard]] const Eigen::VectorXd& held_force() const { return held_force_; }

 private:
  [[nodiscard]] bool is_due(const PredictorCorrector& command, int delay) const noexcept;

  std::vector<int> delay_substeps_;
  std::vector<bool> sampled_;
  double previous_word_ = 0, number_ = 1;
  int stop_countdown_ = -1;
  bool switch_pc_ = false;
  bool at_target_ = false;
  Eigen::VectorXd held_displacement_, held_force_;
};

}  // namespace rths::controller
