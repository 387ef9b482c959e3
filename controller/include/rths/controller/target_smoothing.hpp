// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include <rths/controller/filters.hpp>
#include <rths/controller/pole_chain.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

struct TargetSmoothingSettings {
  double period = 1e-3;     ///< of the samples [s]
  double smoothing = 2e-3;  ///< time constant of each of five poles [s]
  double average = 0;       ///< length of a moving average; 0: none [s]
  double oil_column = 0;    ///< frequency that a notch takes out; 0: none [Hz]
};

/// Smooths a target and differentiates it. A moving average over the interval of a target's steps
/// takes out their frequency and its multiples, a notch that of the oil columns, and five poles
/// what is above. `sharp` undoes all of it by their power series in the backward difference, up to
/// the fourth. So slow motion is neither late nor smaller, and fast motion is not amplified.
class TargetSmoothing {
 public:
  static constexpr int kPoles = 5;
  static constexpr int kDerivatives = 5;  ///< from the value to the fourth
  using Derivatives = Eigen::Matrix<double, kDerivatives, 1>;

  /// @throws Error if a setting is out of range   @setup
  explicit TargetSmoothing(const TargetSmoothingSettings& settings);

  /// Takes a sample. The first one is the state at rest.   @realtime
  void advance(double target) RTHS_REALTIME;
  /// Derivatives of the smoothed target, those of the last sample [unit/sᵏ].
  [[nodiscard]] const Derivatives& smoothed() const { return smoothed_; }
  /// Those of this time after the last sample, less than a period, by Taylor's series [unit/sᵏ].
  /// @realtime
  [[nodiscard]] Derivatives smoothed_after(double time) const RTHS_REALTIME;
  /// Derivatives of the target itself from those of the smoothed one [unit/sᵏ].   @realtime
  [[nodiscard]] Derivatives sharpened(const Derivatives& smoothed) const RTHS_REALTIME {
    return sharpening_ * smoothed;
  }
  /// Of slow motion [s].
  [[nodiscard]] double delay() const { return sharpening_(0, 1); }

 private:
  double smoothing_;
  MovingAverage average_;
  Notch notch_;
  PoleChain<kPoles> poles_;
  Eigen::Matrix<double, kDerivatives, kDerivatives> sharpening_;
  Derivatives smoothed_ = Derivatives::Zero();
};

}  // namespace rths::controller
