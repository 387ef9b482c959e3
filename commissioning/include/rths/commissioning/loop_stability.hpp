// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <vector>

#include <rths/sim/axis_transfer.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/isolated_plant.hpp>

namespace rths::commissioning {

/// The compensation as a linear lead: reference = Σ a_k x^(k) + c F + c' Ḟ, with the command x and
/// the specimen's force F.
struct LinearLead {
  std::array<double, 5> command{1, 0, 0, 0, 0};  ///< a_k [s^k]
  std::array<double, 2> force{};                 ///< c [m/N], c' [m·s/N]
};

/// The loop of a hybrid test along one axis, linear about an amplitude of its specimen:
///     1 + N(A) H(iω) T(iω) = 0
/// H: displacement of the structure by a force on all its bearings, without bearings. N: describing
/// function of the specimen, N = (ω/πA) ∫ F e^{−iωt} dt over a cycle of amplitude A. T:
/// displacement of the machine by the command, compensation included.
class HybridLoop {
 public:
  /// @param plant  of the test   @param axis  0: long, 1: lat
  /// @param machine  identified   @param mass  of the platen [kg]
  /// @param extra_delay  of the controller [s]
  /// @param rate  wall time over model time   @setup
  HybridLoop(const sim::PlantMatrices& plant, int axis, const sim::AxisTransfer& machine,
             double mass, const LinearLead& lead, double extra_delay, double rate);

  /// A loop with a stated flexibility H [m/N] at frequencies of the model time [rad/s] that rise,
  /// and a transfer function T [-]: for other structures and machines.
  HybridLoop(std::vector<double> omega, std::vector<std::complex<double>> flexibility,
             std::vector<std::complex<double>> transfer);

  /// Number of poles with a positive real part, from the phase of
  ///     (1 + g N H T e^{−iωτ}) / (1 + N H)
  /// over all frequencies: −π for each (argument principle). Without the machine the loop is
  /// stable.
  /// @param stiffness  N [N/m]   @param delay  τ, added to the loop, model time [s]
  /// @param gain  g, of the measured force [-]
  [[nodiscard]] int unstable_poles(std::complex<double> stiffness, double delay = 0,
                                   double gain = 1) const;

  /// Smallest added delay that makes the loop unstable [s]; 0: it is unstable; `most` if none is.
  [[nodiscard]] double delay_margin(std::complex<double> stiffness, double most = 0.2) const;
  /// Smallest factor above 1 on the force that makes it unstable; 1: it is unstable.
  [[nodiscard]] double gain_margin(std::complex<double> stiffness, double most = 100) const;

 private:
  /// Machine and specimen exchange the force, so T depends on the stiffness.
  [[nodiscard]] std::vector<std::complex<double>> transfer(std::complex<double> stiffness) const;
  [[nodiscard]] int poles_of(std::complex<double> stiffness,
                             const std::vector<std::complex<double>>& transfer, double delay,
                             double gain) const;

  std::vector<double> omega_;
  std::vector<std::complex<double>> flexibility_, given_transfer_;
  sim::AxisTransfer machine_;
  double mass_ = 0, extra_delay_ = 0, rate_ = 1;
  LinearLead lead_;
};

/// Describing function of a bearing along one axis [N/m].
/// @param amplitude [m]   @param frequency [Hz]   @setup
[[nodiscard]] std::complex<double> describing_function(const sim::Bearing& bearing,
                                                       double amplitude, double frequency);

/// Transfer function of a machine that carries a specimen: displacement over reference.
/// @param stiffness  of the specimen [N/m]   @param mass  of the platen [kg]
/// @param omega  [rad/s]   @setup
[[nodiscard]] std::complex<double> transfer_at(const sim::AxisTransfer& machine,
                                               std::complex<double> stiffness, double mass,
                                               double omega);

/// Stability at one amplitude.
struct AmplitudeMargin {
  double amplitude = 0;            ///< of the specimen [m]
  std::complex<double> stiffness;  ///< N [N/m]
  bool stable = false;
  double delay_margin = 0;  ///< [s]
  double gain_margin = 1;   ///< [-]
};

}  // namespace rths::commissioning
