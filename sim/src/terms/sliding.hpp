// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "kinds.hpp"
#include "plane.hpp"

namespace rths::sim {

// Shared by all sliders. Equations and sources: docs/theory/sliding.md.

/// Properties of stainless steel, which absorbs the heat of a slider. Source: Kumar, Whittaker &
/// Constantinou (2015).
inline constexpr double kSteelConductivity = 18;      ///< [W/(m °C)]
inline constexpr double kSteelDiffusivity = 4.44e-6;  ///< [m²/s]

/// Reference temperature of the friction coefficients [°C].
inline constexpr double kReferenceTemperature = 20;
/// 0.789(0.7^(T/50 °C) + 0.4), written as r + (1 − r) e^(−(T − 20 °C)/T_s).
inline constexpr double kResidualFriction = 0.4 / (0.86703978530 + 0.4);  ///< r [-]
inline constexpr double kTemperatureScale = 140.183663;  ///< T_s = 50/ln(1/0.7) [°C]

/// Temperature rise of a surface for ∫q/√s = 1 [°C/(W/m² √s)]: √(D/π)/k.
[[nodiscard]] inline double steel_heating(double conductivity, double diffusivity) {
  return std::sqrt(diffusivity / std::numbers::pi) / conductivity;
}

/// Friction of a bilinear slider: elastic with `stiffness` up to `yield`, then sliding. Radial
/// return, backward Euler.
/// @param force  in: before the step; out: after the step
template <class Real>
void slide(Plane<Real>& force, const Plane<Real>& increment, const Real& stiffness,
           const Real& yield) {
  force = force + increment * stiffness;
  const Real size = length(force);
  if (!(yield > 0))
    force = {};
  else if (size > yield)
    force = force * (yield / size);
}

/// Compression on a slider; 0 in tension.
template <class Real>
[[nodiscard]] Real contact_load(const Quantities<Real>& q) {
  return q.axial_load > 0 ? q.axial_load : Real{0};
}

// Kinds, in the order in which they act within a stage.
std::span<const TermKind> sliding_vertical_kinds();
std::span<const TermKind> sliding_modifier_kinds();
std::span<const TermKind> slider_kinds();
std::span<const TermKind> stop_kinds();
std::span<const TermKind> triple_pendulum_kinds();

}  // namespace rths::sim
