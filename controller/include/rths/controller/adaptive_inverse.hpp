// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include <rths/controller/inverse_lead.hpp>
#include <rths/core/realtime.hpp>
#include <rths/maths/low_pass.hpp>

namespace rths::controller {

struct AdaptiveInverseSettings : InverseLeadSettings {
  InverseCoefficients initial;
  InverseCoefficients uncertainty{0.005,  0.01,  3e-4,   3e-6,
                                  0.4e-9, 2e-11, 0.5e-3, 0.02};  ///< standard deviations; 0: fixed
  double forgetting = 10;           ///< time constant of the memory, in informative motion [s]
  double error = 5e-3;              ///< standard deviation of an error that is not learnt [m]
  double cutoff = 15;               ///< of the signals that are learnt from [Hz]
  double informative_speed = 0.01;  ///< learning pauses while the target's RMS speed is below [m/s]
  double largest_error = 0.03;      ///< and while |measured − target| is above [m]
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
/// coefficients with a time constant of 0.3 s; each stays within four standard deviations of its
/// start.
class AdaptiveInverse {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit AdaptiveInverse(const AdaptiveInverseSettings& settings);

  /// One sample.
  /// @param target    displacement that the machine should have now [m]; not finite: held
  /// @param measured  displacement [m]   @param force  of the specimen [N]
  /// @param share     of the lead that is sent: 1 the full lead, 0 the bare target
  /// @param adapt     false: the coefficients are frozen
  /// @param pace      of the target; learning pauses while it is slow
  /// @returns the reference, within ±largest_reference [m]   @realtime
  [[nodiscard]] double step(double target, double measured, double force, double share, bool adapt,
                            const Pace& pace = {}) RTHS_REALTIME;

  [[nodiscard]] InverseCoefficients coefficients() const;
  /// True if the last sample entered the fit.
  [[nodiscard]] bool learning() const { return learning_; }
  /// Number of samples with a value that is not finite.
  [[nodiscard]] long bad_samples() const { return bad_samples_; }
  /// Number of samples with the reference at its limit.
  [[nodiscard]] long clipped() const { return clipped_; }

  static constexpr int kTerms = InverseLead::kTerms;

 private:
  using Terms = InverseLead::Terms;
  using Channels = Eigen::Matrix<double, kTerms + 1, 1>;  ///< all terms, and what else was sent

  [[nodiscard]] double sent(double share, const Pace& pace) noexcept;
  [[nodiscard]] bool is_informative(double speed, double error, bool is_good) noexcept;
  void learn(const Channels& sent_now, double error, bool is_good, bool adapt) noexcept;
  void solve() noexcept;

  AdaptiveInverseSettings settings_;
  Terms initial_, uncertainty_;
  Terms change_ = Terms::Zero(), wanted_ = Terms::Zero();  ///< of the coefficients
  Eigen::Matrix<double, kTerms, kTerms> normal_;
  Terms right_side_ = Terms::Zero();
  InverseLead lead_;
  std::array<Channels, 3> machine_;  ///< G: value, rate and second rate of each channel
  std::vector<maths::LowPass> filters_;
  maths::LowPass error_filter_;
  double last_target_ = 0, last_measured_ = 0, last_force_ = 0;
  double mean_square_speed_ = 0;
  long tick_ = 0, bad_samples_ = 0, clipped_ = 0, pause_ = 0;
  bool learning_ = false;
};

}  // namespace rths::controller
