// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <iterator>
#include <limits>

#include <Eigen/Core>

#include <rths/controller/filters.hpp>
#include <rths/controller/path_sampler.hpp>
#include <rths/controller/target_smoothing.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Coefficients of a machine's inverse dynamics along one axis.
///     r = a₀x + a₁ẋ + a₂ẍ + a₃x⃛ + a₄x⁗ + c F + c' Ḟ + b tanh(v/v₀) + k_q v (1/√(1 − ρ) − 1)
/// F: the specimen's force, v: the velocity of the target one lead time ahead, ρ: the share of the
/// machine's force capacity used in the direction of v, including inertia.
struct InverseCoefficients {
  double a0 = 1;              ///< [-]
  double a1 = 0.0508;         ///< [s]
  double a2 = 1.27e-3;        ///< [s²]
  double a3 = 1.7e-5;         ///< [s³]
  double load = 1.25e-9;      ///< c: a loaded servo lags by it [m/N]
  double load_rate = 8e-11;   ///< c': oil that a changing force compresses [m·s/N]
  double dead_band = 0.5e-3;  ///< b: of the valve, as position error [m]
  double flow_loss = 0.0488;  ///< k_q: a loaded valve passes less oil [s]
};

/// A coefficient by its names in a block diagram.
struct InverseCoefficient {
  const char* output;  ///< of a block `adaptive_inverse`
  const char* key;     ///< of the block's table
  double InverseCoefficients::*value;
};
/// In the order of the terms of an InverseLead.
inline constexpr InverseCoefficient kInverseCoefficients[] = {
    {"a0", "a0", &InverseCoefficients::a0},
    {"a1", "a1_s", &InverseCoefficients::a1},
    {"a2", "a2_s2", &InverseCoefficients::a2},
    {"a3", "a3_s3", &InverseCoefficients::a3},
    {"load", "load_m_per_N", &InverseCoefficients::load},
    {"load_rate", "load_rate_m_s_per_N", &InverseCoefficients::load_rate},
    {"dead_band", "dead_band_m", &InverseCoefficients::dead_band},
    {"flow_loss", "flow_loss_s", &InverseCoefficients::flow_loss}};

struct InverseLeadSettings {
  double period = 1e-3;           ///< of the controller [s]
  double a4 = 1e-7;               ///< [s⁴]
  double lead_time = 0.020;       ///< from reference to oil flow [s]
  double sign_velocity = 0.030;   ///< v₀ [m/s]
  double force_capacity = 8.9e6;  ///< [N]
  double effective_mass = 113e3;  ///< [kg]
  double smoothing = 2e-3;        ///< time constant of each of five poles on the target [s]
  double average = 0;             ///< length of the moving average of the target; 0: none [s]
  double oil_column = 0;          ///< frequency that a notch takes out of it; 0: none [Hz]
  int force_slope = 12;           ///< samples of the force in its rate
  double largest_reference = std::numeric_limits<double>::infinity();  ///< clipped there [m]
  double largest_load_lead = 0.01;  ///< clip of the terms with the measured force [m]
};

/// The lead of a target that a machine of known inverse dynamics needs to follow it. The
/// derivatives are those of a smoothed target, whose delay the lead includes, along the target's
/// path: a target that slows down has the reference that it would have at full pace, later.
class InverseLead {
 public:
  static constexpr int kTerms = std::size(kInverseCoefficients);
  using Terms = Eigen::Matrix<double, kTerms, 1>;

  /// The coefficients in the order of the terms.
  [[nodiscard]] static Terms vector_of(const InverseCoefficients& coefficients);
  [[nodiscard]] static InverseCoefficients coefficients_of(const Terms& terms);

  /// @throws Error if a setting is out of range   @setup
  explicit InverseLead(const InverseLeadSettings& settings);

  /// Takes a sample.
  /// @param target  displacement that the machine should have now [m]   @param force  of the
  /// specimen [N]; its magnitude counts up to the capacity   @realtime
  void advance(double target, double force, const Pace& pace = {}) RTHS_REALTIME;
  /// @param share  of the lead: 1 the full lead, 0 the bare target
  /// @returns the reference of the last sample, within ±largest_reference [m]   @realtime
  [[nodiscard]] double reference(const Terms& coefficients, double share) RTHS_REALTIME;

  /// Of the last sample: what each coefficient is multiplied by.
  [[nodiscard]] const Terms& terms() const { return terms_; }
  [[nodiscard]] double fourth_derivative() const { return fourth_derivative_; }  ///< [m/s⁴]
  /// True if the last reference, or its terms with the force, stood at a limit.
  [[nodiscard]] bool is_clipped() const { return is_clipped_; }

 private:
  InverseLeadSettings settings_;
  PathSampler targets_, forces_;
  TargetSmoothing smoothing_, clock_smoothing_;
  EndSlope force_slope_;
  Terms terms_ = Terms::Zero();
  double target_ = 0, fourth_derivative_ = 0, force_rate_ = 0;
  bool is_clipped_ = false;
};

}  // namespace rths::controller
