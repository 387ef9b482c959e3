// SPDX-License-Identifier: Apache-2.0
// Lead heated by dissipated work: docs/theory/lead_rubber.md, "Heating".
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "elastomeric.hpp"
#include "fading_memory.hpp"
#include "kinds.hpp"
#include "plane.hpp"
#include "work_taken.hpp"

namespace rths::sim {
namespace {

struct AdiabaticHeating : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "adiabatic_heating";
  static constexpr Text kTitle = "strength that falls with dissipated work";
  static constexpr Text kEquation =
      "Q = Q_0 exp(-b W),  k = k_0 exp(-s b W),  dW/dt = F_h.v - W/t_c";
  static constexpr Text kSource = "Kalpakidis & Constantinou 2009, without conduction";
  enum { kSoftening, kCoolingTime, kElasticShare };
  static constexpr Parameter kParameters[] = {{"softening", "1/J", 0, 1e6, 0, 1.2e-7},
                                              {"cooling_time", "s", 1e-2, 1e12, 1e12, 100},
                                              kElasticShareParameter};
  static constexpr std::size_t kStates = kWorkStates + 1;  // W

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    Real& kept = term.state[kWorkStates];
    // Implicit, so it decays with any step size.
    kept = (kept + work_taken(term.state, q, Real{0})) /
           (1 + term.time_step / term.parameters[kCoolingTime]);
    const Real weaker = term.parameters[kSoftening] * kept;
    q.strength *= exp(-weaker);
    q.elastic_stiffness *= exp(-term.parameters[kElasticShare] * weaker);
  }
};

// Memory of a plug face's temperature: a fading memory of y = q a/k, where q is the flux through
// the face and y the temperature difference that q causes over one radius:
//     T = present y + Σ memory,   then memory ← decay memory + intake y
// `constants` are present, decays, intakes, in the order of prepare_fading_memory.
template <class Real>
Real remembered(const Real* memory) {
  constexpr std::size_t kChains = 4;  // independent sums, for speed
  static_assert(kFadingExponentials % kChains == 0);
  std::array<Real, kChains> sums{};
  for (std::size_t i = 0; i < kFadingExponentials; i += kChains)
    for (std::size_t j = 0; j < kChains; ++j) sums[j] += memory[i + j];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

// Nothing here shares memory, so that a compiler may take several exponentials at once.
template <class Real>
void take_in(const double* __restrict constants, Real* __restrict memory, const Real y) {
  const double* decay = constants + 1;
  const double* intake = decay + kFadingExponentials;
  for (std::size_t i = 0; i < kFadingExponentials; ++i)
    memory[i] = memory[i] * decay[i] + y * intake[i];
}

// Ratio of a disc on a half-space to an infinite face, in the kernel's spectrum around rate s, in
// units of diffusivity/radius². The ratio oscillates faster than the spacing of the memory's rates,
// so each rate uses the mean over its neighbourhood.
double disc_factor(double s) {
  constexpr int kPoints = 16;
  constexpr double kNeighbourhood = 0.8;  // in ln s: about the spacing of two rates
  constexpr double kLikeInfinite = 400;   // beyond it the ratio differs from 1 by less than 1e-4
  double sum = 0;
  for (int i = 0; i < kPoints; ++i) {
    const double x = std::sqrt(s * std::exp(kNeighbourhood * ((i + 0.5) / kPoints - 0.5)));
    sum += x > kLikeInfinite ? 1 : 1 - std::cyl_bessel_j(1.0, 2 * x) / x;
  }
  return sum / kPoints;
}

struct LeadHeating : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "lead_heating";
  static constexpr Text kTitle = "lead-core heating";
  static constexpr Text kEquation =
      "Q = Q_0 exp(-c T),  C h dT/dt = F_h.v/(pi a^2) - q_ends - (t_s/a) q_shims;  "
      "T = each flux convolved with the rate of its face's step response";
  static constexpr Text kSource =
      "Kalpakidis & Constantinou 2009; Duhamel's integral for any history";
  enum {
    kSoftening,
    kRadius,
    kHeight,
    kShims,
    kCapacity,
    kConductivity,
    kDiffusivity,
    kElasticShare
  };
  // Radius and diffusivity enter the constants, so they cannot be fitted.
  static constexpr Parameter kParameters[] = {
      {"softening", "1/K", 0, 1, 0, 0.0069},
      {"lead_radius", "m", 1e-3, 100, 0.18, 0.18},
      {"lead_height", "m", 1e-3, 10, 0.37, 0.37},
      {"shim_thickness", "m", 0, 10, 0.12, 0.12},  // of all shims together
      {"lead_heat_capacity", "J/m3/K", 1, 1e8, 1.456e6, 1.456e6},
      {"steel_conductivity", "W/m/K", 0, 1e4, 50, 50},  // 0: no heat loss
      {"steel_diffusivity", "m2/s", 1e-8, 1e-2, 1.41e-5, 1.41e-5},
      {"elastic_share", "-", 0, 1, 0, 0}};  // 1: Q|v||z| heats, even before yield
  static constexpr std::size_t kTemperature = kWorkStates, kEnds = kTemperature + 1,
                               kShimFaces = kEnds + kFadingStates;

  static TermSize size(const TermSetup&) {
    return {kShimFaces + kFadingStates, 2 * kFadingConstants};
  }

  static void prepare(const TermSetup& setup, std::span<double> constants) {
    const double radius = setup.parameters[kRadius];
    const double rate = setup.parameters[kDiffusivity] / (radius * radius);  // tau = rate t
    const auto ends = constants.first(kFadingConstants);
    prepare_scaled(0.5, setup.time_step, std::sqrt(rate / std::numbers::pi), ends);
    // F(tau) = 2 sqrt(tau/pi) - 2 tau/pi + … If a step is too long for the series, half of the
    // first term is used: for small radii the exponentials hold the memory.
    ends[0] = std::max(ends[0] - 2 / std::numbers::pi * rate * setup.time_step, 0.5 * ends[0]);
    for (std::size_t i = 1; i <= kFadingExponentials; ++i)
      ends[kFadingExponentials + i] *= disc_factor(-std::log(ends[i]) / (setup.time_step * rate));
    // Step response of the shims: tau^(1/3)/1.274.
    constexpr double kShimFactor = 1.274;
    prepare_scaled(2.0 / 3, setup.time_step, std::cbrt(rate) / (3 * kShimFactor),
                   constants.last(kFadingConstants));
  }

  static void prepare_scaled(double power, double time_step, double factor,
                             std::span<double> constants) {
    prepare_fading_memory(power, time_step, constants);
    constants[0] *= factor;
    for (double& intake : constants.last(kFadingExponentials)) intake *= factor;
  }

  // Heat balance of the plug at the end of the step, solved for T; the fluxes follow from T.
  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const double* ends = term.constants;
    const double* shims = ends + kFadingConstants;
    Real& temperature = term.state[kTemperature];
    const Real heat = p[kCapacity] * p[kHeight];  // [J/m2/K]
    const Real area = p[kRadius] * p[kRadius] * Real{std::numbers::pi};
    const Real loss = p[kConductivity] * Real{term.time_step} / (p[kRadius] * heat);
    const Real at_ends = remembered(term.state + kEnds);
    const Real at_shims = remembered(term.state + kShimFaces);
    const Real by_ends = loss * Real{1 / ends[0]};
    const Real by_shims = loss * p[kShims] / p[kRadius] * Real{1 / shims[0]};
    temperature = (temperature + work_taken(term.state, q, p[kElasticShare]) / (area * heat) +
                   by_ends * at_ends + by_shims * at_shims) /
                  (1 + by_ends + by_shims);
    take_in<Real>(ends, term.state + kEnds, (temperature - at_ends) * Real{1 / ends[0]});
    take_in<Real>(shims, term.state + kShimFaces, (temperature - at_shims) * Real{1 / shims[0]});
    q.strength *= exp(-p[kSoftening] * temperature);
  }
};

}  // namespace

std::span<const TermKind> lead_heating_kinds() { return kinds_of<AdiabaticHeating, LeadHeating>(); }

}  // namespace rths::sim
