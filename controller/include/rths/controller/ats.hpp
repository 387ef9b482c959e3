// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/filters.hpp>
#include <rths/core/realtime.hpp>
#include <rths/maths/low_pass.hpp>

namespace rths::controller {

struct AtsSettings {
  double period = 0.001;                      ///< of the controller [s]
  Eigen::Vector3d initial{1, 0.040, 0.0008};  ///< a0 [-], a1 [s], a2 [s²]: 1, τ, τ²/2
  Eigen::Vector3d lowest{0.7, 0, 0};          ///< range clip
  Eigen::Vector3d highest{1.3, 0.08, 0.0032};
  Eigen::Vector3d largest_change{2, 0.05, 0.001};  ///< per sample
  double threshold = 0.254e-3;  ///< adaptation begins at this measured displacement [m]
  double window = 1.0;          ///< of the fit [s]
  int decimation = 16;          ///< one sample in `decimation` enters the fit
  int filter_order = 6;
  double filter_cutoff = 20;  ///< [Hz]
  int smoothing = 1;          ///< length of the reference's moving average [samples]; 1: none
  double quiet_rms = 0;       ///< the coefficients are frozen while the RMS of the measured
                              ///< displacement over the window is below this [m]; 0: never
};

/// Adaptive time series compensator: a lead whose coefficients adapt to the machine's delay.
///
///     reference = a0 x + a1 ẋ + a2 ẍ
///     (a0, a1, a2) = argmin Σ (u_f − a0 x_m − a1 ẋ_m − a2 ẍ_m)²    over the last second
///
/// u_f: the reference before smoothing, x_m: the measured displacement, both through the same
/// low-pass; ẋ_m, ẍ_m: backward differences. One degree of freedom. Limits act in this order:
/// change per sample, range.
///
/// As at the SRMD, it differs from the original in two ways. x, ẋ, ẍ come from the
/// predictor-corrector, whose polynomials are differentiated exactly. The reference may be smoothed
/// by a moving average; the fit includes its delay and compensates for it.
/// Source: Chae, Kazemibidokhti & Ricles (2013), EESD 42(11):1697–1715.
class Ats {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit Ats(const AtsSettings& settings);

  /// One sample. A command or a measured value that is not a number is left out: the last is held.
  /// @param command   x, ẋ, ẍ [m], [m/s], [m/s²]
  /// @param measured  displacement feedback of this sample [m]
  /// @param share     of the lead that is sent: 1 the full lead, 0 the bare command. The fit uses
  ///                  the reference sent, so the coefficients converge even while the lead is off
  /// @param adapt     false: the coefficients are frozen
  /// @returns the reference [m]   @realtime
  [[nodiscard]] double step(const Eigen::Vector3d& command, double measured, double share,
                            bool adapt) RTHS_REALTIME;

  [[nodiscard]] const Eigen::Vector3d& coefficients() const { return a_; }
  /// Number of samples with a coefficient at a limit.
  [[nodiscard]] long limited() const { return limited_; }

 private:
  struct Sample {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();  ///< x_m, ẋ_m, ẍ_m
    double u = 0;
  };
  void remember(const Sample& sample) noexcept;
  void adapt_coefficients() noexcept;

  AtsSettings settings_;
  maths::LowPass command_filter_, response_filter_;
  MovingAverage smoothing_;
  std::vector<Sample> samples_;  ///< the window, a ring buffer
  std::size_t next_ = 0;         ///< index of the next sample to overwrite
  Eigen::Vector3d last_command_ = Eigen::Vector3d::Zero();
  double last_measured_ = 0;
  double previous_ = 0, previous_difference_ = 0;
  bool triggered_ = false;
  Eigen::Vector3d a_;
  long limited_ = 0;
};

}  // namespace rths::controller
