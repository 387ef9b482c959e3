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
/// 0.789(0.7^(T/50 °C) + 0.4), written as r + (1 − r) e^(−(T − 20 °C)/T_s).
inline constexpr double kResidualFriction = 0.4 / (0.86703978530 + 0.4);  ///< r [-]
inline constexpr double kTemperatureScale = 140.183663;  ///< T_s = 50/ln(1/0.7) [°C]

/// Temperature rise of a surface for ∫q/√s = 1 [°C/(W/m² √s)]: √(D/π)/k.
[[nodiscard]] inline double steel_heating(double conductivity, double diffusivity) {
  return std::sqrt(diffusivity / std::numbers::pi) / conductivity;
}

/// Friction of a bilinear slider: elastic with `stiffness` up to `yield`, then sliding. Exact for a
/// straight path within the step (Krieg & Krieg 1977): while it slides, the friction turns into the
/// direction of motion, tan(θ/2) decays with the path.
/// @param force  in: before the step; out: after the step
template <class Real>
void slide(Plane<Real>& force, const Plane<Real>& increment, const Real& stiffness,
           const Real& yield) {
  if (!(yield > 0)) {
    force = {};
    return;
  }
  const Real before = length(force);
  if (before > yield) force = force * (yield / before);
  const Plane<Real> elastic = increment * stiffness;
  const Real path = length(elastic);
  const Plane<Real> trial = force + elastic;
  if (!(path > 0) || !(dot(trial, trial) > yield * yield)) {
    force = trial;
    return;
  }
  // The path leaves the circle of the yield force after `reach`.
  const Plane<Real> along = elastic * (1 / path);
  const Real forwards = dot(force, along), inside = yield * yield - dot(force, force);
  const Real root = forwards * forwards + inside;
  const Real reach = root > 0 ? Real{sqrt(root) - forwards} : Real{0};
  const Plane<Real> contact = force + along * reach;
  const Plane<Real> across{-along.y, along.x};
  const Real half = dot(contact, across) / (yield + dot(contact, along)) *
                    exp(Real{(reach - path) / yield});  // tan(θ/2)
  const Real scale = yield / (1 + half * half);
  force = along * (scale * (1 - half * half)) + across * (2 * scale * half);
}

/// Compression on a slider; 0 in tension.
template <class Real>
[[nodiscard]] Real contact_load(const Quantities<Real>& q) {
  return q.axial_load > 0 ? q.axial_load : Real{0};
}

}  // namespace rths::sim
