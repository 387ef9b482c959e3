// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <rths/core/config.hpp>
#include <rths/sim/composition.hpp>

#include "support/files.hpp"

namespace rths::sim {
namespace {

constexpr double kSliderLoad = 9.7e6;     // [N]
constexpr double kSliderFriction = 0.1;   // [-]
constexpr double kSliderStiffness = 4e8;  // before sliding [N/m]
constexpr double kTimeStep = 1e-3;        // [s]
constexpr double kPi = std::numbers::pi;

using Terms = std::vector<TermSettings>;

const TermSettings kSlider{
    "flat_slider",
    "",
    {{"friction_coefficient", kSliderFriction}, {"initial_stiffness", kSliderStiffness}}};

// A composition with its state.
struct SlidingBearing {
  Composition composition;
  std::vector<double> state;

  explicit SlidingBearing(const Terms& terms, double time_step = kTimeStep)
      : composition{terms, time_step}, state(composition.states()) {}
  Quantities<double> move(const Horizontal<double>& u, double load = kSliderLoad,
                          const Horizontal<double>& v = {}) {
    Quantities<double> q;
    q.displacement = u;
    q.velocity = v;
    q.axial_load = load;
    composition.advance(state, q);
    return q;
  }
  double force(double u, double load = kSliderLoad, double v = 0) {
    return move({u, 0}, load, {v, 0}).force[0];
  }
};

// A parallelogram: 4 mu N (A − mu N/k0). The trapezoidal rule errs by up to a step at each of the
// four corners.
TEST(FlatSlider, DissipatesTheParallelogramOfACycle) {
  SlidingBearing bearing{{kSlider}};
  const double A = 0.1, yield = kSliderFriction * kSliderLoad;
  const int steps = 20'000;
  double energy = 0, u = 0, force = 0;
  for (int i = 0; i <= 2 * steps; ++i) {
    const double next = A * std::sin(2 * kPi * i / steps);
    const double found = bearing.force(next);
    if (i > steps) energy += 0.5 * (force + found) * (next - u);
    u = next;
    force = found;
  }

  const double expected = 4 * yield * (A - yield / kSliderStiffness);
  EXPECT_NEAR(energy, expected, 1e-4 * expected);
}

// On a circle of radius A the elastic stretch e = mu N/k0 is tangential to the slider's circle,
// whose radius is √(A² − e²). So friction Y acts inwards with Y e/A and backwards with Y √(1 −
// e²/A²).
TEST(SinglePendulum, FollowsACircleInItsClosedForm) {
  const double A = 0.1, R = 2.2, yield = 0.06 * kSliderLoad, e = yield / kSliderStiffness;
  SlidingBearing bearing{{{"single_pendulum",
                           "",
                           {{"friction_coefficient", 0.06},
                            {"initial_stiffness", kSliderStiffness},
                            {"effective_radius", R}}}}};
  const int steps = 20'000;
  double outwards = 0, along = 0;
  for (int i = 0; i <= 2 * steps; ++i) {
    const double angle = 2 * kPi * i / steps;
    const auto force = bearing.move({A * std::cos(angle), A * std::sin(angle)}).force;
    outwards = force[0] * std::cos(angle) + force[1] * std::sin(angle);
    along = -force[0] * std::sin(angle) + force[1] * std::cos(angle);
  }

  // Backward Euler rotates the friction by half a step's angle times A/e: a relative error of 2e-3.
  EXPECT_NEAR(outwards, kSliderLoad * A / R + yield * e / A, 2e-3 * yield);
  EXPECT_NEAR(along, yield * std::sqrt(1 - e * e / (A * A)), 1e-4 * yield);
}

// Friction along x turns into the motion along y: tan(θ/2) = e^(−k0 s/Y), s after the elastic part.
// At right angles, the elastic part is nothing. A straight path needs no small steps.
TEST(FlatSlider, TurnsItsFrictionIntoTheDirectionOfMotion) {
  const double yield = kSliderFriction * kSliderLoad, path = 0.7 * yield / kSliderStiffness;
  for (const int steps : {1, 2, 50}) {
    SlidingBearing bearing{{kSlider}};
    bearing.move({0.05, 0});
    Quantities<double> q;
    for (int i = 1; i <= steps; ++i) q = bearing.move({0.05, path * i / steps});

    const double half = std::exp(-0.7), whole = 1 + half * half;
    EXPECT_NEAR(q.force[0], yield * 2 * half / whole, 1e-9 * yield) << steps;
    EXPECT_NEAR(q.force[1], yield * (1 - half * half) / whole, 1e-9 * yield) << steps;
  }
}

// Backwards at an angle of 30°, friction unloads first: a chord of the circle, then an arc from
// 30°.
TEST(FlatSlider, UnloadsAlongAChordBeforeItSlides) {
  const double yield = kSliderFriction * kSliderLoad, chord = 2 * std::cos(kPi / 6);
  const double path = (chord + 1.5) * yield / kSliderStiffness;
  for (const int steps : {1, 3}) {
    SlidingBearing bearing{{kSlider}};
    bearing.move({0.05, 0});
    Quantities<double> q;
    for (int i = 1; i <= steps; ++i)
      q = bearing.move({0.05 - path * std::cos(kPi / 6) * i / steps, path * 0.5 * i / steps});

    // Angles from the direction of motion.
    const double angle = 2 * std::atan(std::tan(kPi / 6 / 2) * std::exp(-1.5));
    const double along = yield * std::cos(angle), across = yield * std::sin(angle);
    EXPECT_NEAR(-std::cos(kPi / 6) * q.force[0] + 0.5 * q.force[1], along, 1e-9 * yield) << steps;
    EXPECT_NEAR(std::abs(0.5 * q.force[0] + std::cos(kPi / 6) * q.force[1]), across, 1e-9 * yield)
        << steps;
  }
}

TEST(FlatSlider, HasNoForceInUpliftAndStartsAfreshAfterIt) {
  SlidingBearing bearing{{kSlider}};
  bearing.force(0.05);
  EXPECT_EQ(bearing.force(0.06, 0), 0);
  EXPECT_EQ(bearing.force(0.03, -1e6), 0);

  // A tenth of a millimetre of elastic displacement from the point of landing.
  bearing.force(0.03);
  EXPECT_NEAR(bearing.force(0.0301), 1e-4 * kSliderStiffness, 1);
}

TEST(RimStop, PushesBackBeyondItsClearance) {
  SlidingBearing bearing{
      {{"rim_stop", "", {{"stiffness", 1e8}, {"clearance", 0.2}, {"loss", 0.5}}}}};

  EXPECT_EQ(bearing.force(0.199), 0);
  EXPECT_NEAR(bearing.force(0.21), 1e6, 1e-3);
  EXPECT_NEAR(bearing.force(0.21, kSliderLoad, 0.4), 1.2e6, 1e-3);
  const auto force = bearing.move({0.6 * 0.21, -0.8 * 0.21}).force;
  EXPECT_NEAR(force[0], 0.6e6, 1e-3);
  EXPECT_NEAR(force[1], -0.8e6, 1e-3);
}

TEST(MerSpring, BeginsBeyondItsGapOnEitherSide) {
  SlidingBearing bearing{{{"mer_spring", "", {{"stiffness", 12e6}, {"gap", 0.02}}}}};

  EXPECT_EQ(bearing.force(0.02), 0);
  EXPECT_NEAR(bearing.force(0.12), 1.2e6, 1e-3);
  EXPECT_NEAR(bearing.force(-0.12), -1.2e6, 1e-3);
}

// Both springs push until one loses contact: twice the stiffness up to the precompression.
TEST(MerSpring, IsTwiceAsStiffWhileBothArePrecompressed) {
  SlidingBearing bearing{{{"mer_spring", "", {{"stiffness", 12e6}, {"gap", -0.02}}}}};

  EXPECT_NEAR(bearing.force(0.01), 2 * 12e6 * 0.01, 1e-3);
  EXPECT_NEAR(bearing.force(0.05), 12e6 * 0.07, 1e-3);
}

TEST(VelocityDepSliding, RisesFromSlowToFastFriction) {
  SlidingBearing bearing{
      {{"velocity_dep_sliding", "", {{"low_velocity_reduction", 0.4}, {"rate", 50}}}, kSlider}};
  for (const double v : {0.0, 0.01, 0.05, 1.0})
    EXPECT_NEAR(bearing.force(1 + v, kSliderLoad, v) / (kSliderFriction * kSliderLoad),
                1 - 0.4 * std::exp(-50 * v), 1e-12);
}

TEST(PressureDepSliding, LosesThreeTenthsFor50MPa) {
  const double area = 0.1;
  SlidingBearing bearing{
      {{"pressure_dep_sliding",
        "",
        {{"factor_at_50_MPa", 0.7}, {"reference_pressure", 20e6}, {"contact_area", area}}},
       kSlider}};

  EXPECT_NEAR(bearing.force(1, 20e6 * area), kSliderFriction * 20e6 * area, 1e-3);
  EXPECT_NEAR(bearing.force(2, 70e6 * area), 0.7 * kSliderFriction * 70e6 * area, 1e-3);
}

TEST(PressureTanhSliding, LevelsOffAtItsReduction) {
  const double area = 0.1;
  SlidingBearing bearing{
      {{"pressure_tanh_sliding",
        "",
        {{"high_pressure_reduction", 0.5}, {"pressure_scale", 50e6}, {"contact_area", area}}},
       kSlider}};

  const double load = 50e6 * area;
  EXPECT_NEAR(bearing.force(1, load) / (kSliderFriction * load), 1 - 0.5 * std::tanh(1.0), 1e-12);
  EXPECT_NEAR(bearing.force(2, 20 * load) / (kSliderFriction * 20 * load), 0.5, 1e-9);
}

// Flux step: a power P on the area A from t = 0 gives T = 2 (P/A) √(D t/π)/k. The published law
// converts the friction factor back into temperature; the heating friction is prescribed.
TEST(FrictionHeating, RespondsToAFluxStepFromTheFirstTimeStepToAMinute) {
  const double area = 0.25, power = 2e5;  // [m²], [W]: 62 °C after a minute
  const Composition heating{{{"friction_heating", "", {{"heat_share", 1}, {"contact_area", area}}}},
                            kTimeStep};
  std::vector<double> state(heating.states());
  for (int i = 1; i <= 60'000; ++i) {
    state[0] = power, state[1] = 0;  // friction one step before [N], at 1 m/s
    Quantities<double> q;
    q.velocity = {1, 0};
    heating.advance(state, q);
    const double rise =
        -140.183663 * std::log((q.strength - 0.4 / 1.26703978) / (0.86703978 / 1.26703978));
    const double expected = 2 * power / area * std::sqrt(4.44e-6 * i * kTimeStep / kPi) / 18;
    ASSERT_NEAR(rise, expected, 1e-3 * expected + 1e-6) << "step " << i;
  }
}

TEST(FrictionHeating, IsThePublishedLawOfTheTemperature) {
  for (const double rise : {0.0, 30.0, 80.0, 300.0}) {
    const Composition heating{{{"friction_heating", "", {}}}, kTimeStep};
    std::vector<double> state(heating.states());
    Quantities<double> q;
    q.temperature = rise;
    heating.advance(state, q);
    // The published factor 0.789 has three digits, which gives 0.9997 at 20 °C.
    EXPECT_NEAR(q.strength, 0.789 * (std::pow(0.7, (20 + rise) / 50) + 0.4), 5e-4);
  }
}

TEST(FrictionHeating, StopsWhereTheContactLeavesTheMiddle) {
  const double area = 0.25;
  const Composition heating{{{"friction_heating", "", {{"heat_share", 1}, {"contact_area", area}}}},
                            kTimeStep};
  for (const double u : {0.24, 0.26}) {
    std::vector<double> state(heating.states());
    state[0] = 2e5;
    Quantities<double> q;
    q.displacement = {u, 0};
    q.velocity = {1, 0};
    heating.advance(state, q);
    EXPECT_EQ(q.strength < 1 - 1e-6, u < 0.25) << u;
  }
}

TEST(PendulumLift, RaisesTheBearingByTheSagitta) {
  SlidingBearing bearing{{{"pendulum_lift", "", {{"effective_radius", 2}}},
                          {"multilinear_axial", "", {{"stiffness_1", 1e9}}}}};

  EXPECT_NEAR(bearing.move({0.06, 0.08}, 0).axial_load, 1e9 * 0.01 / 4, 1e-3);
}

TEST(MultilinearAxial, PassesItsCornersAndHasNoForceInTension) {
  const Composition axial{{{"multilinear_axial",
                            "",
                            {{"stiffness_1", 1e9},
                             {"knee_1", 1e-3},
                             {"stiffness_2", 3e9},
                             {"knee_2", 2e-3},
                             {"stiffness_3", 5e9},
                             {"damping", 1e7}}}},
                          kTimeStep};
  const auto load = [&](double w, double rate) {
    std::vector<double> state(axial.states());
    Quantities<double> q;
    q.vertical_displacement = w;
    q.vertical_velocity = rate;
    axial.advance(state, q);
    return q.axial_load;
  };
  EXPECT_NEAR(load(-1e-3, 0), 1e6, 1e-3);
  EXPECT_NEAR(load(-2e-3, 0), 4e6, 1e-3);
  EXPECT_NEAR(load(-3e-3, 0), 9e6, 1e-3);
  EXPECT_NEAR(load(-3e-3, -0.1), 10e6, 1e-3);
  EXPECT_EQ(load(-1e-3, 0.2), 0);
  EXPECT_EQ(load(1e-3, 0), 0);
}

// The large cycle of a bearing from a file: strength at zero displacement, force at the peak.
struct Cycle {
  double strength, force;
};
Cycle large_cycle(const std::string& file, double design) {
  const auto path = test::source_tree() / "sim" / "bearings" / file;
  // The published values hold at high velocity and room temperature. This cycle is slow, so the
  // terms of velocity and heat are left out.
  Terms terms;
  for (auto term : read_terms(Config::load(path))) {
    if (term.kind == "velocity_dep_sliding" || term.kind == "friction_heating" ||
        term.kind == "pendulum_lift" || term.kind == "multilinear_axial")
      continue;
    std::erase_if(term.parameters, [](const auto& parameter) {
      return parameter.first == "heat_share" ||
             parameter.first.starts_with("low_velocity_reduction");
    });
    terms.push_back(term);
  }
  SlidingBearing cold{terms};
  Cycle cycle{};
  double last = 0, u = 0;
  const int steps = 8000;
  const double load = 9.6856e6;  // on one bearing, ours [N]
  for (int i = 0; i <= 2 * steps; ++i) {
    const double next = design * std::sin(2 * kPi * i / steps);
    const double force = cold.force(next, load);
    if (i > steps / 2 && u < 0 && next >= 0)
      cycle.strength = last + (force - last) * u / (u - next);
    cycle.force = std::max(cycle.force, force);
    last = force;
    u = next;
  }
  return cycle;
}

TEST(Bearings, EqsbHasThePapersStrengthAndForce) {
  const Cycle cycle = large_cycle("eqsb.toml", 0.152);

  EXPECT_NEAR(cycle.strength, 1.090e6, 0.01 * 1.090e6);
  EXPECT_NEAR(cycle.force, 2.920e6, 0.01 * 2.920e6);
}

TEST(Bearings, TpfbHasThePapersStrengthAndForce) {
  const Cycle cycle = large_cycle("tpfb.toml", 0.584);

  EXPECT_NEAR(cycle.strength, 0.730e6, 0.01 * 0.730e6);
  EXPECT_NEAR(cycle.force, 1.510e6, 0.01 * 1.510e6);
}

}  // namespace
}  // namespace rths::sim
