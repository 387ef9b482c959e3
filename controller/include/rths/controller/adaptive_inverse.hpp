// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/filters.hpp>
#include <rths/controller/pole_chain.hpp>
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

struct AdaptiveInverseSettings {
  double period = 1e-3;  ///< of the controller [s]
  InverseCoefficients initial;
  InverseCoefficients uncertainty{0.005,  0.01,  3e-4,   3e-6,
                                  0.4e-9, 2e-11, 0.5e-3, 0.02};  ///< standard deviations; 0: fixed
  double a4 = 1e-7;                                              ///< not adapted [s⁴]
  double lead_time = 0.020;                                      ///< from reference to oil flow [s]
  double sign_velocity = 0.030;                                  ///< v₀ [m/s]
  double force_capacity = 8.9e6;
  double effective_mass = 113e3;    ///< [kg]
  double smoothing = 2e-3;          ///< time constant of each of five poles on the target [s]
  int force_slope = 12;             ///< samples of the force in its rate
  double forgetting = 10;           ///< time constant of the memory, in informative motion [s]
  double error = 5e-3;              ///< standard deviation of an error that is not learnt [m]
  double cutoff = 15;               ///< of the signals that are learnt from [Hz]
  double informative_speed = 0.01;  ///< learning pauses while the target's RMS speed is below [m/s]
  double largest_error = 0.03;      ///< and while |measured − target| is above [m]
  double largest_reference = std::numeric_limits<double>::infinity();  ///< clipped there [m]
  double largest_load_lead = 0.01;  ///< clip of the terms with the measured force [m]
};

/// Adaptive inverse compensator: a lead whose coefficients are learnt from the measured
/// displacement, by least squares on the derivatives of the target.
///
/// The derivatives come from the target alone, so sensor noise biases no coefficient. They are
/// those of a smoothed target, whose delay the lead includes. With G, the machine that `initial`
/// inverts, the coefficients w minimise
///     Σ (G(r − w·φ) − (x_m − x))² exp(−age/forgetting)/error² + Σ ((w − initial)/uncertainty)²
/// every 50 ms: at the minimum the tracking error is uncorrelated with each term. The second sum
/// keeps a coefficient at its start while the motion does not inform about it. Fades to new
/// coefficients within 0.3 s; each stays within four standard deviations of its start.
class AdaptiveInverse {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit AdaptiveInverse(const AdaptiveInverseSettings& settings);

  /// One sample.
  /// @param target    displacement that the machine should have now [m]; not finite: held
  /// @param measured  displacement [m]   @param force  of the specimen [N]
  /// @param share     of the lead that is sent: 1 the full lead, 0 the bare target
  /// @param adapt     false: the coefficients are frozen
  /// @returns the reference, within ±largest_reference [m]   @realtime
  [[nodiscard]] double step(double target, double measured, double force, double share,
                            bool adapt) RTHS_REALTIME;

  [[nodiscard]] InverseCoefficients coefficients() const;
  /// True if the last sample entered the fit.
  [[nodiscard]] bool learning() const { return learning_; }
  /// Number of samples with a value that is not finite.
  [[nodiscard]] long bad_samples() const { return bad_samples_; }
  /// Number of samples with the reference at its limit.
  [[nodiscard]] long clipped() const { return clipped_; }

  static constexpr int kTerms = 8;  ///< adapted coefficients
  static constexpr int kPoles = 5;  ///< of the smoothing

 private:
  using Terms = Eigen::Matrix<double, kTerms, 1>;
  using Channels = Eigen::Matrix<double, kTerms + 1, 1>;  ///< all terms, and what else was sent
  using Derivatives = Eigen::Matrix<double, kPoles + 1, 1>;

  [[nodiscard]] Derivatives smoothed_derivatives(double target) noexcept;
  [[nodiscard]] Terms terms_of(const Derivatives& smoothed, double force) noexcept;
  [[nodiscard]] double sent(double target, const Terms& terms, double share) noexcept;
  [[nodiscard]] bool is_informative(double speed, double error, bool is_good) noexcept;
  void learn(const Channels& sent_now, double error, bool is_good, bool adapt) noexcept;
  void solve() noexcept;

  AdaptiveInverseSettings settings_;
  Terms initial_, uncertainty_;
  Terms change_ = Terms::Zero(), wanted_ = Terms::Zero();  ///< of the coefficients
  Eigen::Matrix<double, kTerms, kTerms> normal_;
  Terms right_side_ = Terms::Zero();
  /// Row k: the k-th derivative of the target from those of the smoothed one.
  Eigen::Matrix<double, 5, kPoles + 1> sharpening_;
  PoleChain<kPoles> poles_;  ///< of the target
  EndSlope force_rate_;
  std::array<Channels, 3> machine_;  ///< G: value, rate and second rate of each channel
  std::vector<LowPass> filters_;
  LowPass error_filter_;
  double fourth_derivative_ = 0, last_target_ = 0, last_measured_ = 0, last_force_ = 0;
  double mean_square_speed_ = 0;
  long tick_ = 0, bad_samples_ = 0, clipped_ = 0, pause_ = 0;
  bool learning_ = false;
};

}  // namespace rths::controller
