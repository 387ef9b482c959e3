// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/realtime.hpp>

namespace rths::sim::machine {

/// Friction of one surface along one axis, with presliding (LuGre):
///
///     ż = v − σ₀ |v| z / g(v),   g(v) = F_c + (F_s − F_c) exp(−(v/v_s)²)
///     F = σ₀ z + σ₁ ż + σ₂ v
///
/// At rest it is a spring σ₀; in steady sliding it is g(v) sign(v) + σ₂ v.
/// Source: Canudas de Wit, Olsson, Åström & Lischinsky (1995), IEEE TAC 40(3):419–425.
struct LuGre {
  double presliding = 1e-5;         ///< F_c/σ₀ [m]
  double stribeck_ratio = 1;        ///< F_s/F_c [-], ≥ 1
  double stribeck_velocity = 5e-3;  ///< v_s [m/s]
  double micro_damping = 0;         ///< σ₁ over σ₀ [s]

  /// Advances the deflection z [m] by `time_step` at constant velocity, exactly, and returns F
  /// without σ₂ v [N].
  /// @param coulomb   F_c, ≥ 0 [N]   @realtime
  [[nodiscard]] double advance(double& z, double velocity, double coulomb,
                               double time_step) const RTHS_REALTIME;
};

}  // namespace rths::sim::machine
