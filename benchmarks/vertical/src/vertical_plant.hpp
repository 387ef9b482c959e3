// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace rths::bench {

/// The vertical axis of a bearing machine with its bearing, in this bench's own equations.
///     servo      w = K_v (r(t − τ) − x) A/Q_r − K_p P/P_s            |w| ≤ 1
///     spool      ẍ_v = ω² (w − x_v) − 2 ζ ω ẋ_v
///     flow       Q = Q_r y √(1 − sgn(y) P/P_s),  y = x_v outside the dead band, else 0
///     oil        Ṗ = (4 B/V)(Q − A ẋ − C P)
///     platen     m ẍ = A P − F − F_f z
///     bearing    F = K₀/(1 + κ u²) (x − u²/(2 R)) + c ẋ,  u: horizontal displacement
struct VerticalMachine {
  double area = 2.58;           ///< A of the four actuators [m²]: 53.4 MN
  double volume = 0.786;        ///< V [m³]
  double bulk_modulus = 1.4e9;  ///< [Pa]
  double supply = 20.7e6;       ///< P_s [Pa]
  double leakage = 1e-9;        ///< C [m³/(s·Pa)]
  double rated_flow = 0.75;     ///< Q_r [m³/s]
  double valve_frequency = 20;  ///< [Hz]
  double valve_damping = 0.8;
  double dead_band = 0.005;
  double position_gain = 20.5;  ///< K_v [1/s]
  double pressure_gain = 0.1;
  double transport = 0.002;        ///< [s]
  double mass = 115e3;             ///< [kg]
  double friction = 20e3;          ///< [N]
  double stiffness = 5e9;          ///< K₀ [N/m]
  double softening = 37.5;         ///< κ: 0.4 K₀ at 200 mm [1/m²]
  double lift_radius = 10;         ///< R [m]
  double viscosity = 2e6;          ///< c [N·s/m]
  double force_noise = 20e3;       ///< standard deviation [N]
  double horizontal_noise = 5e-5;  ///< [m]
};

/// Nominal for seed 0, else drawn: bulk modulus ±20 %, valve ±15 %, dead band 0.5 to 2 %, friction
/// ±50 %, K₀, κ and R ±10 %.
[[nodiscard]] VerticalMachine draw_vertical(int seed);

/// The machine in motion at 1 kHz.
class VerticalRun {
 public:
  VerticalRun(const VerticalMachine& machine, double preload, std::uint64_t seed);
  /// One period. @param horizontal  displacement of the bearing at its end [m]
  void step(double reference, double horizontal);
  [[nodiscard]] double force() const { return force_; }  ///< true [N]
  [[nodiscard]] double measured_force() { return force_ + machine_.force_noise * normal_(random_); }
  [[nodiscard]] double measured_horizontal() {
    return horizontal_ + machine_.horizontal_noise * normal_(random_);
  }

 private:
  struct State {
    double x = 0, v = 0, pressure = 0, spool = 0, spool_rate = 0;
  };
  [[nodiscard]] State rates(const State& s, double reference, double horizontal) const;
  [[nodiscard]] double bearing_force(const State& s, double horizontal) const;

  VerticalMachine machine_;
  State state_;
  std::vector<double> delay_;
  std::size_t head_ = 0;
  double force_ = 0, horizontal_ = 0;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_{0, 1};
};

}  // namespace rths::bench
