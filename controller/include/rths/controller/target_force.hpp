// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/specimen_model.hpp>
#include <rths/core/realtime.hpp>

namespace rths::controller {

/// Parallel sliders of unit strength, which follow a motion in the plane of the axes:
///     sharp:   dz = du/r within |z| ≤ 1, radial return to |z| = 1
///     smooth:  dz = du/r − z max(0, z·du/r)
/// A smooth slider is the law of Bouc and Wen with exponent 2 and β = γ.
class Sliders {
 public:
  /// @param sharp,smooth  r: displacements at which they slip [m], > 0   @setup
  Sliders(const std::vector<double>& sharp, const std::vector<double>& smooth, Eigen::Index axes);
  /// @param step  axes × 1, displacement since the last call [m]   @realtime
  void move(const Eigen::VectorXd& step) RTHS_REALTIME;
  /// axes × sliders [-], the sharp ones first
  [[nodiscard]] const Eigen::MatrixXd& states() const { return states_; }

 private:
  Eigen::Index sharp_;           ///< number of sharp sliders
  Eigen::VectorXd flexibility_;  ///< 1/r [1/m]
  Eigen::MatrixXd states_;
};

struct TargetForceSettings {
  int axes = 2;
  double period = 1e-3;    ///< of the samples [s]
  double interval = 0.01;  ///< between two targets [s]
  /// The assumed specimen, which takes the place of the sliders; empty: sliders.
  MakeSpecimen specimen;
  /// Displacements at which the sharp sliders slip [m]. The last one stands for a spring.
  std::vector<double> reach{0.5e-3, 1e-3, 2e-3, 3e-3, 4.5e-3, 7e-3, 12e-3, 1.0};
  /// The same of the smooth sliders [m].
  std::vector<double> smooth_reach{0.9e-3, 1.25e-3, 1.8e-3, 2.5e-3, 3.55e-3, 5e-3, 7.1e-3};
  /// Strengths before anything is learnt, of the sharp sliders, then of the smooth ones [N]. Empty:
  /// unknown, no correction until then.
  std::vector<double> expected;
  double forgetting = 8;            ///< time constant of the memory, in informative motion [s]
  double informative_speed = 0.01;  ///< learning pauses while the RMS speed is below [m/s]
  /// Below it the motion follows the displacement, above it the integrated acceleration [Hz]. The
  /// noise is least where both contribute equally: √(σ_a/σ_x)/2π.
  double motion_bandwidth = 5;
  double lead_time = 0;  ///< of the force ahead [s]; 0: none
};

/// Corrects the specimen's force for the tracking error. The force was measured at the measured
/// displacement x_m, but the integrator needs it at its target x:
///     F(x) = F_m + Σ Q_j (z_j(x) − z_j(x_m)),    Q_j ≥ 0
/// The parts z_j follow both motions: the assumed specimen, scaled to a force of 1 on a first move,
/// and a spring beside it, or else sliders, sharp and smooth. Their strengths Q_j, one set for all
/// axes, are learnt from the measured force and motion by least squares with forgetting. A specimen
/// whose force the parts describe returns exactly the force at its target.
///
/// The same parts state the force one lead time τ ahead, free of sensor noise:
///     F(t + τ) = Σ Q_j z_j(x + τẋ + τ²ẍ/2) + the learnt offset of the measured force
class TargetForce {
 public:
  /// @throws Error if a setting is out of range   @setup
  explicit TargetForce(const TargetForceSettings& settings);
  ~TargetForce();
  TargetForce(TargetForce&&) noexcept;
  TargetForce& operator=(TargetForce&&) noexcept;

  struct Sample {
    const double* target;        ///< [m], one value per axis, as the others
    const double* displacement;  ///< measured [m]
    const double* acceleration;  ///< measured [m/s²]
    const double* force;         ///< of the specimen [N]
    /// Command and its rates, for the force ahead; nullptr: none.
    const double* command = nullptr;               ///< [m]
    const double* command_velocity = nullptr;      ///< [m/s]
    const double* command_acceleration = nullptr;  ///< [m/s²]
    /// Compression of the specimen [N]; not a number: that at rest.
    double axial_load = std::numeric_limits<double>::quiet_NaN();
  };
  /// A sample with a value that is not finite repeats the last good one and is not learnt from.
  /// @param adapt  false: the strengths are frozen   @realtime
  void step(const Sample& sample, bool adapt) RTHS_REALTIME;

  /// To be added to the measured force, axes × 1 [N].
  [[nodiscard]] const Eigen::VectorXd& correction() const;
  /// Force of the specimen one lead time after the command of the last sample, axes × 1 [N]. Zero
  /// without a lead time, without a command, and until strengths are known.
  [[nodiscard]] const Eigen::VectorXd& ahead() const;
  /// Q_j [N]
  [[nodiscard]] const Eigen::VectorXd& strengths() const;
  [[nodiscard]] bool learning() const;  ///< True if the last sample entered the fit.
  /// Samples with a target or a measured value that is not a number.
  [[nodiscard]] long bad_samples() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::controller
