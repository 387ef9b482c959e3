// SPDX-License-Identifier: Apache-2.0
// Lead plugs heated by dissipated work, against closed forms.
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <rths/sim/composition.hpp>

namespace rths::sim {
namespace {

using std::numbers::pi;

constexpr double kPlugStrength = 1.01e6;
constexpr double kPlugYield = 2.855e-3;
constexpr double kDesignDisplacement = 0.210;
constexpr double kSoftening = 0.0069;

struct Plug {
  double radius = 0.18, height = 0.37, shims = 0.12, capacity = 1.456e6;
  double conductivity = 50, diffusivity = 1.41e-5;
  double softening = kSoftening;

  [[nodiscard]] double area() const { return pi * radius * radius; }
  [[nodiscard]] TermSettings term() const {
    return {"lead_heating",
            "",
            {{"softening", softening},
             {"lead_radius", radius},
             {"lead_height", height},
             {"shim_thickness", shims},
             {"lead_heat_capacity", capacity},
             {"steel_conductivity", conductivity},
             {"steel_diffusivity", diffusivity}}};
  }
};

TermSettings lead_plug() {
  return {"bouc_wen",
          "",
          {{"characteristic_strength", kPlugStrength}, {"yield_displacement", kPlugYield}}};
}

// Moves the bearing along a line and calls `see` after each step.
void run(const TermSettings& heating, double time_step, double duration,
         const std::function<double(double)>& displacement,
         const std::function<void(double, const Quantities<double>&)>& see, double origin = 0) {
  const Composition bearing{{lead_plug(), heating}, time_step};
  std::vector<double> state(bearing.states());
  const auto steps = static_cast<int>(std::lround(duration / time_step));
  for (int i = 0; i <= steps; ++i) {
    Quantities<double> q;
    q.time = origin + i * time_step;
    q.displacement[0] = displacement(i * time_step);
    bearing.advance(state, q);
    see(i * time_step, q);
  }
}

// Negligible softening, so that strength and power stay constant.
constexpr double kThermometer = 1e-9;
double temperature(const Quantities<double>& q) { return -std::log(q.strength) / kThermometer; }

double cycles(double t) { return kDesignDisplacement * std::sin(2 * pi * 0.5 * t); }

// Without cooling, dT = Q ds/(C A h) and Q = Q_0 exp(-c T) have the solution Q = Q_0/(1 + b s),
// b = c Q_0/(C A h), over the plastic path s. From rest, z = tanh takes u_y ln 2 of the path. Each
// reversal takes u_y until z is 0, u_y/2 for the elastic work, and u_y ln 2 again; u_y is
// proportional to the strength.
class Adiabatic : public testing::Test {
 protected:
  static void expect_decay(const TermSettings& heating, double softening) {
    const double dt = 1e-3, start = 0.5, half_cycle = 1;
    const double b = softening * kPlugStrength;
    double energy = 0, force = 0, before = 0, energy_at_turn = 0, path_at_turn = 0;
    double path = kDesignDisplacement - kPlugYield * std::log(2.0);
    int turns = 0;
    run(heating, dt, start + 20 * half_cycle, cycles, [&](double t, const Quantities<double>& q) {
      energy += 0.5 * (force + q.force[0]) * (q.displacement[0] - before);
      force = q.force[0];
      before = q.displacement[0];
      if (std::abs(t - start - turns * half_cycle) > dt / 2) return;
      if (turns > 0) {
        const double yield = kPlugYield / (1 + b * path);
        path += 2 * kDesignDisplacement - yield * (1.5 + std::log(2.0));
      }
      // The strength changes by 1 % during elastic unloading: 1 % of a reversal's path.
      const double tolerance = 1e-3;
      EXPECT_NEAR(q.strength, 1 / (1 + b * path), tolerance) << turns << " turns";
      if (turns > 0) {
        const double expected = std::log((1 + b * path) / (1 + b * path_at_turn)) / softening;
        EXPECT_NEAR(energy - energy_at_turn, expected, tolerance * expected) << turns;
      }
      energy_at_turn = energy;
      path_at_turn = path;
      ++turns;
    });
    EXPECT_EQ(turns, 21);
  }
};

TEST_F(Adiabatic, EnergyAndStrengthDecayOverTenCyclesAtDesignDisplacement) {
  Plug plug;
  plug.conductivity = 0;
  expect_decay(plug.term(), kSoftening / (plug.capacity * plug.height * plug.area()));
}

TEST_F(Adiabatic, TheSimpleLawDecaysAlike) {
  expect_decay({"adiabatic_heating", "", {{"softening", 1.2e-7}}}, 1.2e-7);
}

TEST(AdiabaticHeating, ForgetsItsWorkWithItsCoolingTime) {
  const double softening = 1.2e-7, cooling_time = 10, stop = 1;
  double work_at_stop = 0;
  run(
      {"adiabatic_heating", "", {{"softening", softening}, {"cooling_time", cooling_time}}}, 1e-3,
      20, [&](double t) { return 0.5 * std::min(t, stop); },
      [&](double t, const Quantities<double>& q) {
        const double work = -std::log(q.strength) / softening;
        if (t < stop + 0.01) work_at_stop = work;
        // Implicit Euler: a relative error of dt/2 per cooling time.
        else
          EXPECT_NEAR(work, work_at_stop * std::exp(-(t - stop - 0.01) / cooling_time),
                      2e-3 * work_at_stop);
      });
}

// K&C's step response of a disc on a half-space, as published.
double published_response(double tau) {
  if (tau < 0.6) {
    const double x = tau / 4;
    return 2 * std::sqrt(tau / pi) - tau / pi * (2 - x - x * x - 3.75 * x * x * x);
  }
  const double y = 4 * tau;
  return 8 / (3 * pi) -
         1 / (2 * std::sqrt(pi * tau)) * (1 - 1 / (3 * y) + 1 / (6 * y * y) - 1 / (12 * y * y * y));
}

// A plug without heat capacity transmits all its power: a constant flux, for which the published
// response is exact. Without shims.
TEST(LeadHeating, RespondsToAConstantFluxAtItsEndsAsPublished) {
  for (const double radius : {0.05, 0.18}) {
    Plug plug;
    plug.radius = radius, plug.capacity = 1, plug.shims = 0, plug.softening = kThermometer;
    const double flux = kPlugStrength / plug.area();
    run(
        plug.term(), 1e-2, 200, [](double t) { return t; },
        [&](double t, const Quantities<double>& q) {
          if (t < 3) return;  // until yield, and half a step
          const double expected = flux * radius / plug.conductivity *
                                  published_response(plug.diffusivity * t / (radius * radius));
          ASSERT_NEAR(temperature(q), expected, 0.005 * expected) << radius << " m, " << t << " s";
        });
  }
}

TEST(LeadHeating, RespondsToAConstantFluxAtItsShimsAsPublished) {
  Plug plug;
  // The shims have so much steel that the ends are negligible.
  plug.capacity = 1, plug.shims = 10, plug.softening = kThermometer;
  const double flux = kPlugStrength / plug.area();
  run(
      plug.term(), 1e-2, 200, [](double t) { return t; },
      [&](double t, const Quantities<double>& q) {
        if (t < 1) return;
        const double tau = plug.diffusivity * t / (plug.radius * plug.radius);
        const double shims = 1.274 * plug.shims / plug.radius / std::cbrt(tau);
        const double ends = 1 / published_response(tau);
        const double alone = flux * plug.radius / plug.conductivity / shims;
        ASSERT_LT(temperature(q), alone * 1.001);
        ASSERT_GT(temperature(q), alone / (1 + 1.5 * ends / shims));
      });
}

// Under constant power the fluxes grow with the temperature. The published balance assumes each
// flux constant since time began and so loses less heat. For a steadily rising temperature, the
// flux into a half-space is 2 √(τ/π) against the published √(πτ)/2, larger by 4/π - 1. Spreading
// and shims reduce the difference.
TEST(LeadHeating, StaysJustBelowThePublishedBalanceUnderConstantPower) {
  Plug plug;
  plug.softening = kThermometer;
  const double dt = 1e-3, speed = 0.3, heat = plug.capacity * plug.height;
  const double rise = kPlugStrength * speed / plug.area() / heat;  // [K/s]
  double published = 0;
  run(
      plug.term(), dt, 20, [&](double t) { return speed * t; },
      [&](double t, const Quantities<double>& q) {
        if (t > 1) {
          const double loss = rise * t - published;
          ASSERT_LT(temperature(q), published) << t;
          const double way_to_yield = rise * kPlugYield / speed;
          ASSERT_GT(temperature(q), published - (4 / pi - 1) * loss - way_to_yield) << t;
        }
        const double tau = plug.diffusivity * (t + dt / 2) / (plug.radius * plug.radius);
        const double conductance =
            plug.conductivity / plug.radius *
            (1 / published_response(tau) + 1.274 * plug.shims / plug.radius / std::cbrt(tau));
        published += dt * (rise - conductance * published / heat);
      });
}

// A wide plug without shims is a heat capacity on a half-space in one dimension. An impulse E
// decays as T = E/C exp(b² t) erfc(b √t), b = k/(C √D). Constant power P gives its integral,
//     T = P/(C b²) (exp(b² t) erfc(b √t) - 1 + 2 b √(t/π)),
// and bursts are sums of such terms.
double one_dimensional(double power, double capacity, double b, double t) {
  if (t <= 0) return 0;
  const double x = b * std::sqrt(t);
  return power / (capacity * b * b) * (std::exp(x * x) * std::erfc(x) - 1 + 2 * x / std::sqrt(pi));
}

struct Bursts {
  static constexpr double kSpeed = 0.4;
  static double travel(double t) {  // 4 s on, 16 s off, three times
    double s = 0;
    for (int i = 0; i < 3; ++i) s += kSpeed * std::clamp(t - 20.0 * i, 0.0, 4.0);
    return s;
  }
  static double temperature(double flux, double capacity, double b, double t) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
      sum += one_dimensional(flux, capacity, b, t - 20.0 * i) -
             one_dimensional(flux, capacity, b, t - 20.0 * i - 4);
    return sum;
  }
};

Plug wide_plug() {
  Plug plug;
  // Short, so that it loses much of its heat.
  plug.radius = 50, plug.shims = 0, plug.height = 0.02, plug.softening = kThermometer;
  return plug;
}

TEST(LeadHeating, CoolsBetweenBurstsAsAHeatCapacityOnAHalfSpace) {
  const Plug plug = wide_plug();
  const double capacity = plug.capacity * plug.height;
  const double b = plug.conductivity / (capacity * std::sqrt(plug.diffusivity));
  const double flux = kPlugStrength * Bursts::kSpeed / plug.area();
  double hottest = 0, coolest_after = 1e9, now = 0;
  for (const double dt : {1e-3, 1e-2}) {
    run(plug.term(), dt, 60, Bursts::travel, [&](double t, const Quantities<double>& q) {
      now = temperature(q);
      hottest = std::max(hottest, now);
      if (t > 20 && t < 21) coolest_after = std::min(coolest_after, now);
      const double rise = flux / capacity * 4;  // of one burst without heat loss
      // Half a step's power, the path to yield, and the memory's 0.05 %.
      const double tolerance =
          flux / capacity * (0.5 * dt + 2 * kPlugYield / Bursts::kSpeed) + 2e-3 * rise;
      ASSERT_NEAR(now, Bursts::temperature(flux, capacity, b, t), tolerance) << dt << ", " << t;
    });
  }
  EXPECT_LT(coolest_after, 0.7 * hottest);
}

TEST(LeadHeating, DoesNotDependOnTheOriginOfTimeAndIsFiniteFromTheFirstStep) {
  std::vector<double> now, later;
  run(Plug{}.term(), 1e-2, 20, cycles,
      [&](double, const Quantities<double>& q) { now.push_back(q.force[0]); });
  run(
      Plug{}.term(), 1e-2, 20, cycles,
      [&](double, const Quantities<double>& q) { later.push_back(q.force[0]); }, 1e4);

  EXPECT_TRUE(std::isfinite(now[0]));
  EXPECT_EQ(now, later);
}

TEST(LeadHeating, HardlyDependsOnTheSamplingRate) {
  double strengths[3];
  const double steps[] = {1e-3, 2e-3, 1e-2};
  for (int i = 0; i < 3; ++i)
    run(Plug{}.term(), steps[i], 20, cycles,
        [&](double, const Quantities<double>& q) { strengths[i] = q.strength; });

  // Half a step's heat: 10 K/s · 5 ms · 0.0069.
  EXPECT_NEAR(strengths[1], strengths[0], 1e-4);
  EXPECT_NEAR(strengths[2], strengths[0], 5e-4);
}

}  // namespace
}  // namespace rths::sim
