// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/floor_spectrum.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

// A peak between two points of a sine is missed by 1 − cos(π/20), 1.2 %, at most.
constexpr double kPartsPerPeriod = 20;

// Exact step of ẍ + 2ζω ẋ + ω² x = −a(t) for a(t) linear over the step:
//     (x, ẋ)⁺ = A (x, ẋ) + B (a, a⁺)
struct OscillatorStep {
  double A[2][2], B[2][2];
  double omega, damping_ratio;
};

OscillatorStep oscillator_step(double omega, double zeta, double h) {
  const double root = std::sqrt(1 - zeta * zeta);
  const double omega_d = omega * root;
  const double decay = std::exp(-zeta * omega * h);
  const double s = std::sin(omega_d * h);
  const double c = std::cos(omega_d * h);
  const double w2 = omega * omega;
  const double w3h = w2 * omega * h;
  const double z1 = (2 * zeta * zeta - 1) / (w2 * h);
  const double z2 = 2 * zeta / w3h;
  OscillatorStep step{};
  step.omega = omega;
  step.damping_ratio = zeta;
  step.A[0][0] = decay * (zeta / root * s + c);
  step.A[0][1] = decay * s / omega_d;
  step.A[1][0] = -omega / root * decay * s;
  step.A[1][1] = decay * (c - zeta / root * s);
  step.B[0][0] = decay * ((z1 + zeta / omega) * s / omega_d + (z2 + 1 / w2) * c) - z2;
  step.B[0][1] = -decay * (z1 * s / omega_d + z2 * c) - 1 / w2 + z2;
  const double dc = c - zeta / root * s;
  const double ds = omega_d * s + zeta * omega * c;
  step.B[1][0] = decay * ((z1 + zeta / omega) * dc - (z2 + 1 / w2) * ds) + 1 / (w2 * h);
  step.B[1][1] = -decay * (z1 * dc - z2 * ds) - 1 / (w2 * h);
  return step;
}

// On the straight line from sample i − 1 to sample i.
double between(std::span<const double> values, std::size_t i, int part, int parts) {
  return values[i - 1] + (values[i] - values[i - 1]) * part / parts;
}

struct Oscillator {
  double x = 0, v = 0;

  // Returns the absolute acceleration at the end of the step.
  double advance(const OscillatorStep& step, double a0, double a1) {
    const double next_x =
        step.A[0][0] * x + step.A[0][1] * v + step.B[0][0] * a0 + step.B[0][1] * a1;
    v = step.A[1][0] * x + step.A[1][1] * v + step.B[1][0] * a0 + step.B[1][1] * a1;
    x = next_x;
    return -(2 * step.damping_ratio * step.omega * v + step.omega * step.omega * x);
  }
};

}  // namespace

std::vector<double> spectrum_frequencies(double lowest, double highest, int count) {
  std::vector<double> frequencies;
  for (int i = 0; i < count; ++i)
    frequencies.push_back(lowest *
                          std::pow(highest / lowest, static_cast<double>(i) / (count - 1)));
  return frequencies;
}

std::vector<double> floor_spectrum(std::span<const double> long_acceleration,
                                   std::span<const double> lat_acceleration, double time_step,
                                   std::span<const double> frequencies, double damping_ratio) {
  if (long_acceleration.size() != lat_acceleration.size())
    throw Error{"floor spectrum: the two directions differ in length"};
  std::vector<double> spectrum;
  for (const double frequency : frequencies) {
    const int parts = static_cast<int>(std::ceil(kPartsPerPeriod * frequency * time_step));
    const auto step =
        oscillator_step(2 * std::numbers::pi * frequency, damping_ratio, time_step / parts);
    Oscillator along;
    Oscillator across;
    double peak = 0;
    for (std::size_t i = 1; i < long_acceleration.size(); ++i)
      for (int part = 0; part < parts; ++part) {
        const double a = along.advance(step, between(long_acceleration, i, part, parts),
                                       between(long_acceleration, i, part + 1, parts));
        const double b = across.advance(step, between(lat_acceleration, i, part, parts),
                                        between(lat_acceleration, i, part + 1, parts));
        peak = std::max(peak, std::hypot(a, b));
      }
    spectrum.push_back(peak);
  }
  return spectrum;
}

}  // namespace rths::sim
