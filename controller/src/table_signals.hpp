// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <rths/controller/table_force.hpp>
#include <rths/maths/low_pass.hpp>
#include <rths/maths/robust_covariance.hpp>

namespace rths::controller {

inline constexpr double kLongestAccelerometerDelay = 0.020;  // [s]

/// Delays a signal by a fraction of a sample too: cubic interpolation between samples.
class FractionalDelay {
 public:
  FractionalDelay(double delay, double period);
  [[nodiscard]] double operator()(double input) noexcept;

 private:
  std::vector<double> samples_;  // ring buffer, newest at next_ − 1
  std::size_t next_ = 0, whole_ = 0;
  std::array<double, 4> weights_{};
  bool started_ = false;
};

/// Displacement and velocity without lag: integrates the acceleration, and follows the displacement
/// below a bandwidth. Removes a constant error of the accelerometer.
class FusedMotion {
 public:
  FusedMotion(double bandwidth, double period);
  /// @returns the velocity [m/s]
  [[nodiscard]] double operator()(double displacement, double acceleration) noexcept;
  [[nodiscard]] double displacement() const { return x_; }  ///< [m]

 private:
  double period_, gain_x_, gain_v_, gain_bias_;
  double x_ = 0, v_ = 0, bias_ = 0, last_acceleration_ = 0;
  bool started_ = false;
};

/// Delay of the accelerometer behind the displacement transducer [s]: least squares of the
/// acceleration over second and third derivative of the displacement. 0 without motion.   @setup
[[nodiscard]] maths::RobustEstimate accelerometer_behind_displacement(
    std::span<const TableRecording> runs, double period);

/// From measured samples to the terms of the machine's force, all of one instant and through one
/// low-pass. Observer and identification share it, so they share its small errors.
class TableSignals {
 public:
  enum Term { kTableMass, kTableCoulomb, kTableLoad, kTableViscous, kTableOffset, kTableTerms };
  struct Terms {
    Eigen::Matrix<double, kTableTerms, 1> factors;  ///< of m_e, F_s, μ, F_d, d
    double force = 0;                               ///< measured [N]
    double velocity = 0;                            ///< [m/s]
    double displacement = 0;                        ///< [m], without low-pass
  };
  /// @param filter_order  0: no low-pass
  TableSignals(double accelerometer_delay, double presliding, const TableObserverSettings& settings,
               int filter_order, double displacement_lead = 0);
  [[nodiscard]] Terms step(const TableSample& sample) noexcept;

 private:
  FractionalDelay displacement_, force_, load_;
  FusedMotion velocity_;
  double presliding_, period_, friction_state_ = 0, last_velocity_ = 0;
  std::vector<maths::LowPass>
      filters_;  // one per term but the constant one, and the force; or none
  std::optional<Eigen::Matrix<double, kTableTerms, 1>> first_;
};

}  // namespace rths::controller
