// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include <Eigen/Core>

#include <rths/controller/polynomials.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// States of the predictor-corrector, with the numbers used in the field's recordings.
enum class PcState : int { Initialize = -1, Correct = 0, Predict = 1, AutoSlowDown = 2 };

struct PredictorCorrectorSettings {
  int axes = 1;                 ///< controlled degrees of freedom, ≥ 1
  int substeps = 100;           ///< N, controller substeps per integration step, ≥ 1
  double slow_down_from = 0.6;  ///< fraction of the step after which a late target slows the
                                ///< command down [-]; the charts in use have 0.8 or 0.6
  /// Fraction of the step at which a late target holds the command [-]; 0: in the middle between
  /// `slow_down_from` and the end of the step, as in the charts in use.
  double hold_at = 0;
  Polynomial predictor = Polynomial::D2;
  Polynomial corrector = Polynomial::D2;
  double simulation_step = 0.01;     ///< wall time per integration step [s]
  double integration_step = 0.01;    ///< model time per integration step [s]
  bool targets_carry_rates = false;  ///< DV, DVA: use the targets' velocities and accelerations
                                     ///< instead of differences of the target history
  double largest_xi = 0.95;          ///< cap on ξ, which bounds the corrector's weights [-], < 1
};

/// One target of the integrator. Rates are in model time; only DV and DVA use them.
struct Target {
  Eigen::VectorXd displacement;  ///< axes × 1 [m, rad]
  Eigen::VectorXd velocity;      ///< axes × 1 [m/s, rad/s]
  Eigen::VectorXd acceleration;  ///< axes × 1 [m/s², rad/s²]
};

/// The predictor-corrector: turns targets that arrive once per integration step, and may be late,
/// into a smooth command for every substep of the controller.
///
/// While the integrator computes, the command is extrapolated (Predict). If the target is late, the
/// substep counter i slows down towards the hold point (AutoSlowDown). When the target arrives, the
/// command reaches it by the end of the step (Correct). Let p = slow_down_from, h = the hold point:
///
///     Correct       Δi = clamp(Δi_SD + (i − i_SD)/((h−p) N), 0.001, 1);   i ← min(i + Δi, N)
///     Predict       i ← i + 1
///     AutoSlowDown  Δi_SD = (h − i/N)/(h−p);   i ← i + Δi_SD;   i_SD ← i
///
/// If the way from p N to h N takes at most one substep, the command holds and starts again at
/// once. With N = 1 and targets in time, the command is the newest target.
///
/// The transition rules are in docs/theory/predictor_corrector.md. A late target changes when the
/// command passes a point of its path, never the path itself, and the rates are those along the
/// path. So a compensator that counts the time of the path, which is that of the clock less
/// `lost_time`, sends the same reference more slowly.
/// Source: the Stateflow charts of OpenFresco (Schellenberg), whose hold point is (1 + p)/2.
class PredictorCorrector {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit PredictorCorrector(const PredictorCorrectorSettings& settings);

  /// One substep.
  /// @param new_target  true in exactly one substep per target
  /// @param target      the newest target; read when `new_target` is true, and in the first
  ///                    substep, where it is the initial setpoint   @realtime
  void substep(bool new_target, const Target& target) RTHS_REALTIME;
  /// A substep in which the command waits, because its time has passed already.   @realtime
  void wait() RTHS_REALTIME;

  [[nodiscard]] const Eigen::VectorXd& command() const { return command_; }  ///< [m, rad]
  /// Along the path: of a command that is not slowed down [m/s, rad/s].
  [[nodiscard]] const Eigen::VectorXd& command_velocity() const { return velocity_; }
  /// Along the path [m/s², rad/s²].
  [[nodiscard]] const Eigen::VectorXd& command_acceleration() const { return acceleration_; }
  /// By which the command is behind one whose targets were never late [s].
  [[nodiscard]] double lost_time() const { return lost_time_; }
  [[nodiscard]] PcState state() const { return state_; }
  /// i, 0…N. N while idle in Initialize: the specimen is at its target.
  [[nodiscard]] double counter() const { return counter_; }
  [[nodiscard]] const PredictorCorrectorSettings& settings() const { return settings_; }

 private:
  void start_at(const Eigen::VectorXd& setpoint) noexcept;
  void enter_correct(const Target& target) noexcept;
  void enter_predict() noexcept;
  void correct() noexcept;
  void slow_down() noexcept;
  void shift_history(const Target& target) noexcept;
  void evaluate(Branch branch) noexcept;
  void advance_to(double counter) noexcept;

  PredictorCorrectorSettings settings_;
  double hold_point_;  ///< h: fraction of the step at which a late target holds the command [-]
  double ramp_;        ///< (h − p) N, at least 1 [substeps]
  PcState state_ = PcState::Initialize;
  bool started_ = false;
  double counter_ = 0;              ///< i
  double slow_down_increment_ = 1;  ///< Δi_SD
  double slow_down_end_ = 0;        ///< i_SD
  double xi_ = 0;
  double lost_time_ = 0;
  std::array<Eigen::VectorXd, 6> history_;  ///< s₁…s₆, newest first
  std::array<Eigen::VectorXd, 2> rate_;     ///< v₁, v₂ per step
  Eigen::VectorXd second_rate_;             ///< a₁ per step²
  Eigen::VectorXd switch_command_;          ///< s_X
  Eigen::VectorXd command_, velocity_, acceleration_;
};

/// Rating of delayed sampling: fine, to be warned about, or refused.
enum class DelayRating { Fine, Warned, Refused };

/// Fraction of the step at which a late target holds the command [-].   @setup
[[nodiscard]] double hold_point(const PredictorCorrectorSettings& settings);

/// Smallest ratio of sampling delay to step that `judge_delay` refuses.   @setup
[[nodiscard]] double refused_delay_ratio(const PredictorCorrectorSettings& settings);

/// Rates delayed sampling by the ratio of delay to step: warned above 0.6, refused from 0.8 on.
/// Delays from the hold point on are refused too: the counter never reaches it while a target is
/// late.   @setup
[[nodiscard]] DelayRating judge_delay(int delay_substeps,
                                      const PredictorCorrectorSettings& settings);

}  // namespace rths::controller
