// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/force_observer.hpp>
#include <rths/controller/table_force.hpp>
#include <rths/controller/target_force.hpp>

#include "hybrid_loop.hpp"

namespace rths::bench {

/// The specimen's force from the measurements of a period: as measured, at the target, and ahead.
class SpecimenForce {
 public:
  /// @param offset  of the load cells [N]; a correction knows its own
  SpecimenForce(const std::optional<ForceCorrection>& correction, const Eigen::Vector2d& offset);
  /// @param target    of the integrator, long and lat [m]
  /// @param commands  of the last period
  void step(const sim::machine::PlatenFeedback& feedback, const Eigen::VectorXd& target,
            const std::array<Command, 2>& commands);
  [[nodiscard]] const Eigen::VectorXd& at_target() const { return at_target_; }  ///< [N]
  /// One lead time after the command, or as measured without a lead time [N].
  [[nodiscard]] const Eigen::VectorXd& ahead() const { return ahead_; }

 private:
  Eigen::Vector2d offset_;
  bool leads_ = false;
  std::vector<controller::ForceObserver> paper_;
  std::vector<controller::TableForceObserver> observers_;
  std::optional<controller::TargetForce> target_force_;
  Eigen::VectorXd at_target_ = Eigen::VectorXd::Zero(2), ahead_ = Eigen::VectorXd::Zero(2);
};

}  // namespace rths::bench
