// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include <rths/controller/table_force.hpp>

namespace rths::bench {

/// A machine of this bench, with an empty table.
///     F = m_e a + (F_s + μ N) z + F_d v + d,    ż = v − |v| z/δ  scaled by 1/δ (LuGre, constant
///     level)
/// The accelerometer is a low-pass of second order behind a transport delay.
struct EmptyTable {
  double mass, coulomb, load_friction, viscous, offset, presliding;
  double accelerometer_frequency;  ///< [Hz]
  double accelerometer_transport;  ///< [s]
  /// What an identification should find; the accelerometer's delay is that of low frequencies.
  [[nodiscard]] controller::TableForce truth() const;
};

/// Draws a machine: the paper's values ± their uncertainty, friction of the load 0.1 to 0.3 %.
[[nodiscard]] EmptyTable draw_machine(std::mt19937_64& random);

enum class TableMotion { Harmonic, Earthquake };

/// Measured signals at 1 kHz.
struct TableRun {
  std::vector<double> displacement, acceleration, force, axial_load;
  double largest_acceleration = 0;  ///< true [m/s²]
  [[nodiscard]] controller::TableRecording view() const {
    return {displacement, acceleration, force, axial_load};
  }
};

/// @param load  mean of the axial load [N]; it varies by 30 %
[[nodiscard]] TableRun drive(const EmptyTable& machine, TableMotion motion, double load,
                             double duration, std::mt19937_64& random);

}  // namespace rths::bench
