// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/target_exchange.hpp>
#include <rths/loop/tick_order.hpp>
#include <rths/loop/transfer_system.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::loop {

/// The predictor-corrector between targets and commands.
struct CommandPath {
  controller::PredictorCorrectorSettings settings;  ///< their axes are those of the interface
  /// Of the feedback behind the command, by axis [substeps]; empty: none.
  std::vector<int> sampling_delay;
  bool is_force_ahead = false;  ///< the force that the transfer system knows is that ahead
};

struct ClosedLoopSettings {
  double period = 0.001;  ///< of controller and machine, wall time [s]
  double rate = 1;        ///< wall time over model time
  /// By degree of freedom with a controlled displacement: the others have no target. Empty: all.
  std::vector<bool> tested{};  // NOLINT(readability-redundant-member-init): g++ warns without
  /// Empty: a target per period, which is the command, and which is reached in the period.
  std::optional<CommandPath> path{};  // NOLINT(readability-redundant-member-init)
  Host host{};                        // NOLINT(readability-redundant-member-init)
  /// Targets act when they are computed, before they arrive: all forces, and the first
  /// displacements as the setpoint of the start. Else both are 0 until the first target arrives.
  bool targets_act_early = false;
};

/// A substructure and a transfer system in a closed loop, in virtual time.
///
/// In a tick, the machine moves and the controller reads its feedback. If a target arrives, the
/// command turns towards it. When the command has reached it, the integrator takes the force,
/// ends its step and begins the next one; its target arrives after the time of computing.
class ClosedLoop {
 public:
  /// Both must outlive the loop. @throws Error if a setting is out of range   @setup
  ClosedLoop(sim::Substructure& substructure, TransferSystem& transfer,
             const ClosedLoopSettings& settings);

  /// One tick of the controller, after those of the machine.
  void tick();

  [[nodiscard]] std::size_t targets() const { return targets_; }  ///< that have arrived
  [[nodiscard]] std::size_t steps() const { return steps_; }      ///< that the integrator has ended
  /// Displacements of the last target that has arrived [m, rad].
  [[nodiscard]] const Eigen::VectorXd& target() const { return arrived_; }

 private:
  /// The predictor-corrector and its handshake with the integrator.
  struct Path {
    Path(const CommandPath& path, std::size_t axes, double period);
    controller::PredictorCorrector command;
    controller::TargetExchange exchange;
    controller::PaceMeter pace;
    long substeps;  ///< in a tick
    bool is_force_ahead;
  };

  void predict();
  void correct(const Eigen::VectorXd& force);
  void move_until(std::size_t controller_tick);
  void send();
  void follow_path();
  void follow_targets();
  void end_step();

  sim::Substructure& substructure_;
  TransferSystem& transfer_;
  ClosedLoopSettings settings_;
  std::size_t interface_, axes_;  ///< degrees of freedom, and those with a controlled displacement
  std::optional<Path> path_;
  controller::Target target_, setpoint_;     ///< of the step begun, and as the path knows it
  Eigen::VectorXd forces_, arrived_forces_;  ///< targets [N, N·m]
  Eigen::VectorXd arrived_;                  ///< the target that the controller knows
  Command sent_;                             ///< in the last tick
  std::vector<double> all_, rates_;          ///< of the interface
  std::size_t tick_, first_tick_, machine_tick_, arrival_;
  std::size_t targets_ = 0, steps_ = 0;
  bool is_under_way_ = false;
};

}  // namespace rths::loop
