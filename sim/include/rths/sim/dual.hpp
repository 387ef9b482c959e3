// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>

namespace rths::sim {

/// A number with its derivatives with respect to a few parameters: forward-mode automatic
/// differentiation. Results computed from duals carry exact derivatives.
///
/// Comparisons use the value alone, so a function with cases is differentiated within its active
/// case. Operators are inlined always: a call takes longer than their arithmetic.
/// Source: Griewank & Walther, Evaluating Derivatives (2008), chapter 3.
struct Dual {
  static constexpr std::size_t kLanes = 4;  ///< parameters differentiated at once

  double value = 0;
  std::array<double, kLanes> derivative{};

  constexpr Dual() = default;
  constexpr Dual(double constant) : value{constant} {}  // NOLINT: constants mix with duals

  /// The parameter whose derivative is in lane `lane`.
  [[nodiscard]] static constexpr Dual variable(double value, std::size_t lane) {
    Dual x{value};
    x.derivative[lane] = 1;
    return x;
  }
  /// f(x) by the chain rule, f and f' at x given.
  [[nodiscard, gnu::always_inline]] constexpr Dual chain(double f, double slope) const {
    Dual y{f};
    for (std::size_t i = 0; i < kLanes; ++i) y.derivative[i] = slope * derivative[i];
    return y;
  }

  [[gnu::always_inline]] constexpr Dual& operator+=(const Dual& other) {
    value += other.value;
    for (std::size_t i = 0; i < kLanes; ++i) derivative[i] += other.derivative[i];
    return *this;
  }
  [[gnu::always_inline]] constexpr Dual& operator-=(const Dual& other) {
    value -= other.value;
    for (std::size_t i = 0; i < kLanes; ++i) derivative[i] -= other.derivative[i];
    return *this;
  }
  [[gnu::always_inline]] constexpr Dual& operator*=(const Dual& other) {
    for (std::size_t i = 0; i < kLanes; ++i)
      derivative[i] = derivative[i] * other.value + value * other.derivative[i];
    value *= other.value;
    return *this;
  }
  [[gnu::always_inline]] constexpr Dual& operator/=(const Dual& other) {
    value /= other.value;
    for (std::size_t i = 0; i < kLanes; ++i)
      derivative[i] = (derivative[i] - value * other.derivative[i]) / other.value;
    return *this;
  }
  [[gnu::always_inline]] constexpr Dual& operator*=(double factor) {
    for (double& slope : derivative) slope *= factor;
    value *= factor;
    return *this;
  }
  [[gnu::always_inline]] constexpr Dual& operator/=(double divisor) {
    for (double& slope : derivative) slope /= divisor;
    value /= divisor;
    return *this;
  }

  [[gnu::always_inline]] friend constexpr Dual operator+(Dual a, const Dual& b) { return a += b; }
  [[gnu::always_inline]] friend constexpr Dual operator-(Dual a, const Dual& b) { return a -= b; }
  [[gnu::always_inline]] friend constexpr Dual operator*(Dual a, const Dual& b) { return a *= b; }
  [[gnu::always_inline]] friend constexpr Dual operator/(Dual a, const Dual& b) { return a /= b; }
  // A constant has no derivatives.
  [[gnu::always_inline]] friend constexpr Dual operator+(Dual a, double b) {
    return a.value += b, a;
  }
  [[gnu::always_inline]] friend constexpr Dual operator+(double a, Dual b) {
    return b.value += a, b;
  }
  [[gnu::always_inline]] friend constexpr Dual operator-(Dual a, double b) {
    return a.value -= b, a;
  }
  [[gnu::always_inline]] friend constexpr Dual operator*(Dual a, double b) { return a *= b; }
  [[gnu::always_inline]] friend constexpr Dual operator*(double a, Dual b) { return b *= a; }
  [[gnu::always_inline]] friend constexpr Dual operator/(Dual a, double b) { return a /= b; }
  [[gnu::always_inline]] friend constexpr Dual operator-(const Dual& a) {
    return a.chain(-a.value, -1);
  }
  friend constexpr bool operator==(const Dual& a, const Dual& b) { return a.value == b.value; }
  friend constexpr auto operator<=>(const Dual& a, const Dual& b) { return a.value <=> b.value; }
};

/// The value of a Dual, or the number itself.
[[nodiscard]] constexpr double value_of(double x) { return x; }
[[nodiscard]] constexpr double value_of(const Dual& x) { return x.value; }

/// True if x equals `number` and has no derivatives. A shortcut for this special value is then
/// exact, derivatives included.
[[nodiscard]] constexpr bool is_just(double x, double number) { return x == number; }
[[nodiscard]] constexpr bool is_just(const Dual& x, double number) {
  return x.value == number && x.derivative == std::array<double, Dual::kLanes>{};
}

// The same functions of doubles, for templates over the number type.
using std::abs, std::acos, std::cbrt, std::cos, std::exp, std::log, std::log1p, std::pow, std::sin,
    std::sqrt, std::tanh;

[[nodiscard]] inline Dual exp(const Dual& x) {
  const double f = std::exp(x.value);
  return x.chain(f, f);
}
[[nodiscard]] inline Dual log(const Dual& x) { return x.chain(std::log(x.value), 1 / x.value); }
[[nodiscard]] inline Dual log1p(const Dual& x) {
  return x.chain(std::log1p(x.value), 1 / (1 + x.value));
}
/// At 0 the slope is infinite; 0 is used instead, which is right for the length of a zero vector.
[[nodiscard]] inline Dual sqrt(const Dual& x) {
  const double f = std::sqrt(x.value);
  return x.chain(f, f > 0 ? 0.5 / f : 0);
}
[[nodiscard]] inline Dual cbrt(const Dual& x) {
  const double f = std::cbrt(x.value);
  return x.chain(f, f != 0 ? 1 / (3 * f * f) : 0);
}
[[nodiscard]] inline Dual tanh(const Dual& x) {
  const double f = std::tanh(x.value);
  return x.chain(f, 1 - f * f);
}
[[nodiscard]] inline Dual sin(const Dual& x) {
  return x.chain(std::sin(x.value), std::cos(x.value));
}
[[nodiscard]] inline Dual cos(const Dual& x) {
  return x.chain(std::cos(x.value), -std::sin(x.value));
}
[[nodiscard]] inline Dual acos(const Dual& x) {
  return x.chain(std::acos(x.value), -1 / std::sqrt(1 - x.value * x.value));
}
[[nodiscard]] inline Dual abs(const Dual& x) { return x.value < 0 ? -x : x; }
/// x^p for x ≥ 0; at x = 0 the derivatives are set to 0.
[[nodiscard]] inline Dual pow(const Dual& x, const Dual& p) {
  const double f = std::pow(x.value, p.value);
  if (!(x.value > 0)) return Dual{f};
  Dual y = x.chain(f, p.value * f / x.value);
  for (std::size_t i = 0; i < Dual::kLanes; ++i)
    y.derivative[i] += f * std::log(x.value) * p.derivative[i];
  return y;
}

}  // namespace rths::sim
