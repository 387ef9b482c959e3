// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

#include <rths/sim/machine/platen_run.hpp>

#include "srmd_file.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim::machine {
namespace {

using test::kAxialLoad;
using test::kPeriod;

constexpr double kSubstep = 1e-4;  // [s]

// Valves closed by their overlap, no friction, no leakage: nothing dissipates.
PlatenMachine conservative_machine() {
  PlatenMachine m = test::srmd_machine_file();
  for (Actuator* a : {&m.along_long, &m.along_lat, &m.vertical}) {
    a->dead_band = 0.4;
    a->leakage = 0;
  }
  m.friction.coulomb.setZero();
  m.friction.viscous.setZero();
  m.friction.coefficient = 0;
  m.outriggers.damping = 0;
  return m;
}

double total(const PlatenEnergy& e) { return e.kinetic + e.potential + e.oil + e.outriggers; }

PlatenReference resting(const PlatenMachine& m) {
  PlatenReference reference;
  reference.axial_load = m.carries_load() ? m.specimen.axial_load : 0;
  return reference;
}

struct Blow {
  int coordinate;
  double rate;  // [m/s], [rad/s]
};
class PlatenBlow : public ::testing::TestWithParam<Blow> {};

// Kinetic energy goes to the oil columns and returns. The midpoint rule gains (ω h)⁴/4 of the
// energy per substep: 3e-7 at 54 Hz, 3e-4 in 0.1 s. Geometry and chambers change with (x/stroke)².
TEST_P(PlatenBlow, KeepsItsEnergyBetweenPlatenAndOil) {
  PlatenRun run{conservative_machine(), kSubstep};
  PlatenFeedback feedback;
  Vector6 rates = Vector6::Zero();
  rates[GetParam().coordinate] = GetParam().rate;
  run.strike(rates);
  const double before = total(run.energy());
  const double kinetic = run.energy().kinetic;
  double least = kinetic;
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(run.step(resting(conservative_machine()), feedback));
    least = std::min(least, run.energy().kinetic);
    ASSERT_NEAR(total(run.energy()), before, 2e-3 * kinetic) << i;
  }
  EXPECT_LT(least, 0.01 * kinetic);  // it did go to the oil
}
INSTANTIATE_TEST_SUITE_P(Coordinates, PlatenBlow,
                         ::testing::Values(Blow{0, 0.05}, Blow{1, 0.05}, Blow{2, 0.01},
                                           Blow{5, 0.05}));

// The period of free vibration is that of the eigenvalue problem.
TEST(PlatenRun, VibratesAtItsNaturalFrequency) {
  const PlatenMachine m = conservative_machine();
  PlatenRun run{m, kSubstep};
  PlatenFeedback feedback;
  Vector6 rates = Vector6::Zero();
  rates[1] = 0.02;
  run.strike(rates);
  std::vector<double> crossings;
  double before = run.velocity()[1];
  for (int i = 1; i < 10'000; ++i) {
    static_cast<void>(run.step(resting(m), feedback));
    const double now = run.velocity()[1];
    if (before < 0 && now >= 0) crossings.push_back((i + before / (before - now)) * kSubstep);
    before = now;
  }

  const double frequency =
      static_cast<double>(crossings.size() - 1) / (crossings.back() - crossings.front());
  EXPECT_NEAR(frequency, natural_frequencies(m)[0], 2e-3 * frequency);
}

// Hydraulic work = change of stored energy + work on friction and specimen + leakage. All powers
// are summed by the trapezoidal rule at each substep. Chambers differ by (0.1 m / 1.5 m)² from
// mid-stroke.
TEST(PlatenRun, BalancesHydraulicPower) {
  PlatenMachine m = test::srmd_machine_with_bearing();
  m.vertical_specimen.radius_of_gyration = 0;
  m.vertical_specimen.damping = 0;
  m.outriggers.damping = 0;
  PlatenRun run{m, kSubstep};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  const auto stored = [&] {
    const double load = run.axial_load();
    return total(run.energy()) + load * load / 2 / m.vertical_specimen.stiffness;
  };
  struct Powers {
    double hydraulic = 0, lost = 0;
  };
  const auto powers = [&] {
    Powers p;
    for (std::size_t i = 0; i < kActuators; ++i) {
      const ActuatorState& s = run.actuator(i);
      p.hydraulic += s.pressure * valve_flow(m.actuator(i), m.supply, s.spool, s.pressure,
                                             run.supply_pressure());
      p.lost += m.actuator(i).leakage * s.pressure * s.pressure;
    }
    for (int axis = 0; axis < 2; ++axis)
      p.lost += run.velocity()[axis] * (run.friction_force(axis) + run.specimen_force()[axis]);
    return p;
  };
  const double before = stored();
  Powers work;
  Powers last = powers();
  for (int i = 0; i < 20'000; ++i) {
    reference.displacement[0] = 0.1 * std::sin(2 * M_PI * 0.5 * i * kSubstep);
    static_cast<void>(run.step(reference, feedback));
    const Powers now = powers();
    work.hydraulic += kSubstep * (last.hydraulic + now.hydraulic) / 2;
    work.lost += kSubstep * (last.lost + now.lost) / 2;
    last = now;
  }

  EXPECT_GT(work.hydraulic, 2e5);
  EXPECT_NEAR(work.hydraulic, stored() - before + work.lost, 0.005 * work.hydraulic);
}

/// Steady-state delay [s] and gain of an axis for a sine with a peak velocity of 0.3 m/s.
std::pair<double, double> response(const PlatenMachine& m, int axis, double frequency,
                                   double feed_forward) {
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  reference.feed_forward = feed_forward;
  std::complex<double> in, out;
  const double amplitude = 0.3 / (2 * M_PI * frequency);
  const int samples = static_cast<int>(3 / frequency / kPeriod);
  for (int i = 0; i < samples; ++i) {
    const double phase = 2 * M_PI * frequency * i * kPeriod;
    reference.displacement[axis] = amplitude * std::sin(phase);
    static_cast<void>(run.step(reference, feedback));
    if (i < samples / 3) continue;  // two cycles
    const auto turn = std::exp(std::complex<double>{0, -phase});
    in += reference.displacement[axis] * turn;
    out += feedback.displacement[axis] * turn;
  }
  const auto h = out / in;
  return {-std::arg(h) / (2 * M_PI * frequency), std::abs(h)};
}

class RawDelay : public ::testing::TestWithParam<double> {};

// The paper: about 60 ms. The band is that of isolated motion.
TEST_P(RawDelay, IsAboutSixtyMilliseconds) {
  for (const int axis : {0, 1}) {
    const auto [delay, gain] = response(test::srmd_machine_with_bearing(), axis, GetParam(), 0);
    EXPECT_GT(delay, 0.055) << axis;
    EXPECT_LT(delay, 0.065) << axis;
    EXPECT_NEAR(gain, 1, 0.06) << axis;
  }
}
INSTANTIATE_TEST_SUITE_P(Frequencies, RawDelay, ::testing::Values(0.2, 0.5, 1.0, 2.0));

// A velocity feed-forward of gain k removes k/K_v of the lag.
TEST(PlatenRun, IsLessLateWithFeedForwardAtTheValves) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  const double without = response(m, 0, 0.5, 0).first;
  const double with = response(m, 0, 0.5, 0.4).first;

  EXPECT_NEAR(without - with, 0.4 / m.along_long.position_gain, 0.1 * (without - with));
}

// Table 2 of the paper: friction of the empty table, identified while it moves.
TEST(PlatenRun, HasTheFrictionOfTableTwoWhenEmpty) {
  PlatenMachine m = test::srmd_machine_file();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference;
  for (int i = 0; i < 2500; ++i) {
    reference.displacement << 0.1e-3 * i, 0.1e-3 * i, 0, 0, 0, 0;
    static_cast<void>(run.step(reference, feedback));
  }
  const Eigen::Vector2d v = run.velocity().head<2>();

  // The vertical actuators carry the platen's weight up to their own vibration: 1 %.
  EXPECT_NEAR(run.friction_force(0), 5100 + 716 * v[0], 51);
  EXPECT_NEAR(run.friction_force(1), 8600 + 870 * v[1], 86);
}

TEST(PlatenRun, HasMoreFrictionUnderLoad) {
  const auto sliding = [](const PlatenMachine& m) {
    PlatenRun run{m, kPeriod};
    PlatenFeedback feedback;
    PlatenReference reference = resting(m);
    for (int i = 0; i < 2500; ++i) {
      reference.displacement[0] = 0.1e-3 * i;
      static_cast<void>(run.step(reference, feedback));
    }
    return run.friction_force(0);
  };
  const double difference =
      sliding(test::srmd_machine_with_bearing()) - sliding(test::srmd_machine_file());

  EXPECT_NEAR(difference, 0.002 * kAxialLoad, 0.03 * 0.002 * kAxialLoad);
}

// The table on rollers resists with the same friction, and with nothing else.
TEST(PlatenRun, CarriesTheLoadOnRollers) {
  PlatenMachine m = test::srmd_machine_file();
  m.has_rollers = true;
  m.specimen = test::plain_lead_rubber();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  double force = 0, load = 0;
  for (int i = 0; i < 2500; ++i) {
    reference.displacement[0] = 0.1e-3 * i;
    static_cast<void>(run.step(reference, feedback));
    if (i < 2000) continue;
    force += (feedback.force[0] - m.transducers.force_offset[0]) / 500;
    load += feedback.force[2] / 500;
  }

  EXPECT_NEAR(load, kAxialLoad, 0.01 * kAxialLoad);
  EXPECT_NEAR(force, 5100 + 716 * 0.1 + 0.002 * kAxialLoad, 0.03 * 0.002 * kAxialLoad);
  EXPECT_EQ(run.specimen_force(), Eigen::Vector2d::Zero());
}

TEST(PlatenRun, LosesItsOilFilmBeyondTheLiftCapacity) {
  PlatenMachine m = test::srmd_machine_with_bearing();
  m.friction.lift_pressure = 5e6 / (kVertical * m.friction.pad_area);  // lifts 5 MN
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  for (int i = 0; i < 2500; ++i) {
    reference.displacement[0] = 0.1e-3 * i;
    static_cast<void>(run.step(reference, feedback));
  }

  double load = 0;  // of all pads together
  for (std::size_t i = kHorizontal; i < kActuators; ++i)
    load += m.vertical.piston_area * run.actuator(i).pressure;
  const double dry = 0.05 * (load - 5e6);
  ASSERT_GT(dry, 2e5);
  EXPECT_NEAR(run.friction_force(0), dry + 5100 + 0.002 * (load - m.weight()), 500);
}

TEST(PlatenRun, CarriesTheSpecimensLoadAtTheStart) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  static_cast<void>(run.step(resting(m), feedback));

  EXPECT_NEAR(run.axial_load(), kAxialLoad, 0.01 * kAxialLoad);
  EXPECT_NEAR(feedback.force[2], kAxialLoad, 0.01 * kAxialLoad);
}

// The cascade: displacement loops inside, force loop outside.
TEST(PlatenRun, FollowsItsLoadReference) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  reference.axial_load = 7e6;
  for (int i = 0; i < 3000; ++i) static_cast<void>(run.step(reference, feedback));

  EXPECT_NEAR(run.axial_load(), 7e6, 0.03 * 7e6);
}

// Moment of the specimen's shear and load tilts the platen; the vertical actuators share the load.
TEST(PlatenRun, RedistributesTheLoadWhenThePlatenIsOffCentre) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  for (int i = 0; i < 3000; ++i) {
    reference.displacement[0] = 0.3 * std::min(1.0, i / 2000.0);
    static_cast<void>(run.step(reference, feedback));
  }
  // Moments about the pitch axis at rest, in the floor's axes: pads' forces at ±1.1 m carry weight
  // at u, load at u/2, and the shear at half the specimen's height above the actuators' level.
  const double u = run.pose().position[0];
  const double top = m.top + m.vertical_specimen.height / 2;
  double pads = 0;
  for (std::size_t i = 0; i < kVertical; ++i)
    pads += m.foot[i][0] * m.vertical.piston_area * run.actuator(kHorizontal + i).pressure;
  const double expected = m.weight() * u + run.axial_load() * u / 2 -
                          run.specimen_force()[0] * top -
                          run.friction_force(0) * 0;  // at two heights: within the tolerance

  EXPECT_NEAR(pads, expected, 0.05 * std::abs(expected));
}

TEST(PlatenRun, LowersTheSupplyPressureInStrongMotion) {
  const PlatenMachine m = test::srmd_machine_file();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference;
  double lowest = run.supply_pressure();
  for (int i = 0; i < 2000; ++i) {
    reference.displacement[0] = 0.3 * std::sin(4.0 * i * kPeriod);
    static_cast<void>(run.step(reference, feedback));
    lowest = std::min(lowest, run.supply_pressure());
  }

  // 1.2 m/s · 0.43 m² · 2/π over 2 s is 0.66 m³, less the pump's 0.16 m³ at most.
  EXPECT_LT(lowest, m.supply.pressure_at(m.supply.gas_volume + 0.4));
  EXPECT_GT(lowest, m.supply.pressure_at(m.supply.gas_volume + 0.75));
}

TEST(PlatenRun, ReportsItsLimits) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  EXPECT_EQ(run.step(reference, feedback), Status::Ok);

  for (int axis = 0; axis < 6; ++axis) {
    PlatenReference beyond = reference;
    beyond.displacement[axis] = 2;
    EXPECT_EQ(run.step(beyond, feedback), Status::LimitExceeded) << axis;
    beyond.displacement[axis] = std::nan("");
    EXPECT_EQ(run.step(beyond, feedback), Status::LimitExceeded) << axis;
  }
  PlatenReference heavy = reference;
  heavy.axial_load = 60e6;
  EXPECT_EQ(run.step(heavy, feedback), Status::LimitExceeded);
  EXPECT_TRUE(feedback.displacement.allFinite() && feedback.force.allFinite());
}

TEST(PlatenRun, IsBitIdenticalForTheSameSeed) {
  const auto sum_of = [](std::uint64_t seed) {
    PlatenMachine m =
        read_platen_machine(Config::load(test::source_tree() / "sim/machines/srmd.toml"));
    m.has_specimen = false;
    m.seed = seed;
    PlatenRun run{m, kPeriod};
    PlatenFeedback feedback;
    double sum = 0;
    for (int i = 0; i < 200; ++i) {
      PlatenReference reference;
      reference.displacement[0] = 0.1 * std::sin(0.01 * i);
      static_cast<void>(run.step(reference, feedback));
      sum += feedback.force.sum() + feedback.displacement.sum() + feedback.acceleration.sum();
    }
    return sum;
  };

  EXPECT_EQ(sum_of(1), sum_of(1));
  EXPECT_NE(sum_of(1), sum_of(2));
}

TEST(PlatenRun, StepsInRealTime) {
  const PlatenMachine m = test::srmd_machine_with_bearing();
  PlatenRun run{m, kPeriod};
  PlatenFeedback feedback;
  PlatenReference reference = resting(m);
  Status status = Status::Ok;
  for (int i = 0; i < 5; ++i) {
    reference.displacement[0] = 0.01 * i;
    EXPECT_REALTIME(status = run.step(reference, feedback));
  }
  EXPECT_EQ(status, Status::Ok);
}

}  // namespace
}  // namespace rths::sim::machine
