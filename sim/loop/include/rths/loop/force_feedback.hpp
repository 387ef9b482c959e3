// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/force_observer.hpp>
#include <rths/controller/table_force.hpp>
#include <rths/controller/target_force.hpp>
#include <rths/loop/transfer_system.hpp>

namespace rths::loop {

/// The correction of the measured force by equation 1 of the paper.
struct MachineForceCorrection {
  std::array<controller::MachineForce, 2> machine;  ///< force that it subtracts: long, lat
  int slope_samples = 32;
};
/// The correction that knows load-dependent and presliding friction.
struct TableForceCorrection {
  std::array<controller::TableForce, 2> machine;  ///< force that it subtracts: long, lat
  controller::TableObserverSettings settings;
};
/// Empty: the table force is fed back.
using ForceCorrection = std::variant<std::monostate, MachineForceCorrection, TableForceCorrection>;

/// Measurements of the horizontal axes in one tick: long, lat.
struct AxisMeasurement {
  Eigen::Vector2d displacement = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d acceleration = Eigen::Vector2d::Zero();  ///< [m/s²]
  Eigen::Vector2d force = Eigen::Vector2d::Zero();         ///< [N]
  double axial_load = 0;                                   ///< compression [N]
};

/// The force that the controller feeds back: the specimen's, of the load cells' and at the target.
class ForceFeedback {
 public:
  /// @param target_force  correction for the tracking error; empty: none
  /// @param period  of the samples [s]   @throws Error if a setting is out of range   @setup
  ForceFeedback(const ForceCorrection& correction,
                const std::optional<controller::TargetForceSettings>& target_force, double period);

  /// One sample: subtracts the machine's own force.
  /// @param waits  the displacement waits for the accelerometer, like the corrected force
  /// @returns the measurements with the specimen's force
  [[nodiscard]] AxisMeasurement corrected(const AxisMeasurement& measured, bool waits);
  /// One sample.
  /// @param specimen  its force and motion, as measured or exact
  /// @param target, last  of the integrator, and the command of the last tick, as to
  /// TransferSystem::measure
  void step(const AxisMeasurement& specimen, const Eigen::VectorXd& target, const Command& last);

  /// Of the specimen at the target, or as measured without that correction [N].
  [[nodiscard]] const Eigen::Vector2d& at_target() const { return at_target_; }
  /// One lead time after the command, or as measured without a lead time [N].
  [[nodiscard]] const Eigen::Vector2d& ahead() const { return ahead_; }

 private:
  std::vector<controller::ForceObserver> by_slope_;
  std::vector<controller::TableForceObserver> by_table_;
  std::optional<controller::TargetForce> target_force_;
  bool leads_;
  Eigen::Vector2d at_target_ = Eigen::Vector2d::Zero(), ahead_ = Eigen::Vector2d::Zero();
};

}  // namespace rths::loop
