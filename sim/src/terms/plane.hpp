// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/dual.hpp>
#include <rths/sim/term.hpp>

namespace rths::sim {

/// A vector in the horizontal plane, long and lat.
template <class Real>
struct Plane {
  Real x{}, y{};

  [[gnu::always_inline]] friend Plane operator+(const Plane& a, const Plane& b) {
    return {a.x + b.x, a.y + b.y};
  }
  [[gnu::always_inline]] friend Plane operator-(const Plane& a, const Plane& b) {
    return {a.x - b.x, a.y - b.y};
  }
  template <class Factor>
  [[gnu::always_inline]] friend Plane operator*(const Plane& a, const Factor& b) {
    return {a.x * b, a.y * b};
  }
};

template <class Real>
[[gnu::always_inline]] inline Real dot(const Plane<Real>& a, const Plane<Real>& b) {
  return a.x * b.x + a.y * b.y;
}

template <class Real>
Real length(const Plane<Real>& a) {
  return sqrt(dot(a, a));
}

template <class Real>
Plane<Real> displacement_of(const Quantities<Real>& q) {
  return {q.displacement[0], q.displacement[1]};
}

template <class Real>
Plane<Real> velocity_of(const Quantities<Real>& q) {
  return {q.velocity[0], q.velocity[1]};
}

}  // namespace rths::sim
