// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/pole_chain.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Force control of an axis in displacement control, as in the paper: an outer force loop around
/// the inner displacement loop.
///     r = F_t/K + g ∫ (F_t − F) dt/K + g T (F_t − F)/K
/// T cancels the inner loop's lag, so the outer loop is an integrator behind the inner delay.
struct ForceCascadeSettings {
  double period = 1e-3;           ///< of the controller [s]
  double stiffness = 5e9;         ///< K: of the specimen [N/m]
  double gain = 15;               ///< g: crossover of the outer loop [rad/s]
  double lag = 0.05;              ///< T [s]
  double reference_limit = 0.02;  ///< of the integral [m]
};

class ForceCascade {
 public:
  /// @throws Error if a setting is not positive; the lag may be 0   @setup
  explicit ForceCascade(const ForceCascadeSettings& settings);
  /// @param target, measured  force, compression positive [N]; not finite: the reference is held
  /// @returns the displacement reference, towards the specimen [m]   @realtime
  [[nodiscard]] double step(double target, double measured) RTHS_REALTIME;

 private:
  ForceCascadeSettings settings_;
  double integral_ = 0, reference_ = 0;
};

/// A bearing along its axis, as the vertical controller assumes it.
///     x = F (1/K + 1/K_s + 1/k_c) + h,    K = K₀/(1 + κ u²),    h = u²/(2 R)
/// u: horizontal displacement. h: height that the bearing loses at u, which the actuator follows;
/// a pendulum gains height.
struct AxialBearing {
  double stiffness = 5e9;  ///< K₀ [N/m]
  double softening = 0;    ///< κ [1/m²]
  /// R: positive if the bearing gets shorter, negative if it gets higher [m]; 0: no change
  double lift_radius = 0;
  double servo_stiffness = 3.8e10;  ///< K_s: force over the error of the loaded servo [N/m]
  double series_stiffness = 0;      ///< k_c: of a compliance in series [N/m]; 0: none

  /// @returns displacement for a force at a horizontal displacement [m]   @realtime
  [[nodiscard]] double displacement(double force, double horizontal) const RTHS_REALTIME;
  /// Its part without force: h [m].   @realtime
  [[nodiscard]] double height_lost(double horizontal) const RTHS_REALTIME;
};

/// A vertical axis of single-acting actuators: the load itself drives the oil out, so that they
/// need more opening downwards than upwards.
///     inverse    r = x + D(s) κ ẋ/g,    D = (1 + 2ζ s/ω + s²/ω²) e^(sτ),    κ = (1 + K/K_oil)/K_v
///     flow       g = √(1 − p) upwards, √p downwards,    p = (F + W)/F_s
struct SingleActingServo {
  double position_gain = 20;      ///< K_v [1/s]
  double valve_frequency = 25;    ///< ω/2π [Hz]
  double valve_damping = 0.8;     ///< ζ [-]
  double delay = 1.6e-3;          ///< τ, less the lead of the bearing's damping [s]
  double oil_stiffness = 1.4e10;  ///< K_oil, of all actuators [N/m]
  double supply_force = 53.4e6;   ///< F_s: of all actuators under the pressure of the supply [N]
  double platen_mass = 113'371;   ///< whose weight W the actuators carry too [kg]
};

struct VerticalForceSettings {
  AxialBearing bearing;
  AdaptiveInverseSettings inverse;  ///< of the axis in displacement control; `load` terms unused
  double observer_bandwidth = 1;    ///< of the disturbance observer [Hz]; 0: none
  double observer_limit = 0.01;     ///< of its correction [m]
  std::optional<SingleActingServo> single_acting;  ///< empty: equal flow in both directions
};

/// Settings for a vertical axis of four actuators: 53.4 MN, valves of 20 Hz.
[[nodiscard]] VerticalForceSettings srmd_vertical();
/// Settings for single-acting actuators: the initial inverse follows from servo and bearing.
/// @param servo_stiffness  force over the error of the loaded servo [N/m]   @setup
[[nodiscard]] VerticalForceSettings single_acting_vertical(const AxialBearing& bearing,
                                                           const SingleActingServo& servo,
                                                           double servo_stiffness);

/// The lead over the flow that a single-acting actuator lacks or gains, D(s) κ ẋ (1/g − 1), from
/// smoothed derivatives of the displacement.
class FlowLead {
 public:
  /// @pre all settings are positive, as single_acting_vertical checks   @setup
  FlowLead(const SingleActingServo& servo, double stiffness, double smoothing, double period);
  /// @param wanted  displacement [m], of which `pace` tells a part that follows the clock
  /// @param load  of the specimen [N]   @realtime
  [[nodiscard]] double step(double wanted, double load, const Pace& pace = {}) RTHS_REALTIME;

 private:
  static constexpr int kPoles = 4;
  [[nodiscard]] double ahead_in(const PoleChain<kPoles>& poles, double since) const noexcept;

  double gain_, first_, second_;  ///< κ [s]; D of the smoothed velocity: 1, first [s], second [s²]
  double weight_, supply_force_, smoothing_, period_;
  PathSampler targets_;
  PoleChain<kPoles> on_path_, in_clock_;  ///< both parts of the displacement [m]
};

/// Force control of a stiff bearing in real time: the force becomes a displacement by the bearing's
/// law, including the height that it loses under horizontal motion, and the adaptive inverse leads
/// that displacement. A disturbance observer removes the slow remainder.
class VerticalForceControl {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit VerticalForceControl(const VerticalForceSettings& settings);
  /// @param target, measured  force, compression positive [N]
  /// @param horizontal_target, horizontal  of the bearing, commanded and measured: lengths of the
  ///                          displacement vectors [m]
  /// @param path_share  progress of the target along its path, of a period. The height that the
  ///     bearing loses follows the clock. While the target waits, the lead of the force fades.
  /// @returns the displacement reference [m]   @realtime
  [[nodiscard]] double step(double target, double measured, double horizontal_target,
                            double horizontal, bool adapt = true,
                            double path_share = 1) RTHS_REALTIME;
  [[nodiscard]] const AdaptiveInverse& inverse() const { return inverse_; }
  [[nodiscard]] double disturbance() const { return disturbance_; }  ///< [m]

 private:
  VerticalForceSettings settings_;
  AdaptiveInverse inverse_;
  std::optional<FlowLead> flow_;
  double disturbance_ = 0, last_target_ = 0, last_wanted_ = 0, last_height_ = 0, lead_ = 1;
};

}  // namespace rths::controller
