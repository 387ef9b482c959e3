// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include <Eigen/Core>

#include <rths/core/realtime.hpp>
#include <rths/maths/low_pass.hpp>

namespace rths::controller {

/// Learns how a measured force follows its command, and replaces that by the command itself:
///     m ≈ m₀ + g (c − c₀) − h ċ,    m' = m₀ + c + a ċ − c₀ + L(m − m₀ − g (c − c₀) + h ċ)
/// c₀ is the first command and m₀ the first measurement. a is the time by which the command that m'
/// answers is ahead of c. A force that is late takes damping from
/// the structure that integrates it; m' does not. The remainder, which gain and lag do not explain,
/// stays in m' up to the cutoff of a low-pass L: above it are noise and modes of the machine.
struct LagCorrectionSettings {
  double period = 1e-3;           ///< of the samples [s]
  double lag = 0;                 ///< h before anything is learnt [s]
  double ahead = 0;               ///< a, ≥ 0 [s]
  double gain_uncertainty = 0.1;  ///< standard deviation of g around 1 [-]
  double lag_uncertainty = 2e-3;  ///< of h [s]
  double noise = 5e4;             ///< standard deviation of m around the model [N]
  double forgetting = 2;          ///< time constant of the memory [s]
  double cutoff = 20;             ///< of the remainder [Hz]
};

class LagCorrection {
 public:
  /// @throws Error if a setting is not positive   @setup
  explicit LagCorrection(const LagCorrectionSettings& settings);
  /// @param command, measured  force [N]; if not finite, the last correction stays
  /// @returns m', or the last one [N]   @realtime
  [[nodiscard]] double step(double command, double measured, bool adapt = true) RTHS_REALTIME;
  [[nodiscard]] double gain() const { return estimate_[1]; }  ///< g [-]
  [[nodiscard]] double lag() const { return estimate_[2]; }   ///< h [s]

 private:
  void learn(const Eigen::Vector3d& terms, double measured) RTHS_REALTIME;

  LagCorrectionSettings settings_;
  double keep_;                        ///< share of the memory after one sample
  Eigen::Vector3d prior_, precision_;  ///< of m₀ less the first measurement, g and h
  Eigen::Matrix3d normal_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d side_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d estimate_;
  std::optional<Eigen::Vector2d> first_ = std::nullopt;  ///< command and measurement [N]
  maths::LowPass remainder_;
  double last_command_ = 0, corrected_ = 0;
};

}  // namespace rths::controller
