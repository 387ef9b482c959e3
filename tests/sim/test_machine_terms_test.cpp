// SPDX-License-Identifier: Apache-2.0
// Effects of terms in a test machine and its specimen.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/sim/test_machine.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"
#include "support/period.hpp"

namespace rths::sim {
namespace {

using Eigen::Vector2d;
using test::error_of;
using test::kAxialLoad;
using test::kPeriod;

constexpr double kSpecimenStiffness = 1e7;  // of a linear specimen [N/m]

Bearing linear_specimen(double stiffness) {
  return {"spring", {{"polynomial_stiffness", "", {{"linear", stiffness}}}}, kAxialLoad};
}

TestMachine bare_machine(const Bearing& specimen) {
  TestMachine machine = srmd_machine();
  machine.noise = {0, 0, 0};
  machine.terms.clear();
  machine.specimen = specimen;
  return machine;
}

struct Seen {
  MachineFeedback feedback;
  Vector2d displacement, specimen_force;
};
/// State after a slow ramp along the long axis to `to` and a rest.
Seen pushed(const TestMachine& machine, double to) {
  TestMachineRun run{machine, kPeriod};
  Seen seen;
  for (int i = 0; i < 6000; ++i)
    static_cast<void>(run.step({to * std::min(1.0, i / 2000.0), 0}, kAxialLoad, seen.feedback));
  seen.displacement = run.true_displacement();
  seen.specimen_force = run.specimen_force();
  return seen;
}
Seen pushed(TestMachine machine, double to, const TermSettings& term) {
  machine.terms.push_back(term);
  return pushed(machine, to);
}

std::string refusal(const TestMachine& machine) {
  return error_of([&] { TestMachineRun(machine, kPeriod); });
}

// Actuator terms change the platen's motion, mount terms the specimen's motion, machine terms the
// table force, and sensor terms only the measurement.
TEST(TestMachineTerms, OfASensorChangeOnlyTheMeasurement) {
  const TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  const Seen without = pushed(machine, 0.1);
  TermSettings gain{"gain", "", {{"factor", 1.1}}};
  gain.channel = SensorChannel::Displacement;

  const Seen with = pushed(machine, 0.1, gain);

  EXPECT_EQ(with.displacement, without.displacement);
  EXPECT_EQ(with.specimen_force, without.specimen_force);
  EXPECT_DOUBLE_EQ(with.feedback.displacement[0], 1.1 * without.feedback.displacement[0]);
}

TEST(TestMachineTerms, OfTheActuatorChangeThePlatensMotion) {
  const TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));

  // At 5 mm/s the platen moves 30 mm in the 6 s of the test.
  const Seen with = pushed(machine, 0.1, {"rate_saturation", "", {{"velocity_limit", 5e-3}}});

  const Seen slow = pushed(machine, 0.03);
  EXPECT_NEAR(with.displacement[0], slow.displacement[0], 1e-3);
}

TEST(TestMachineTerms, OfTheActuatorReceiveTheSpecimensForce) {
  const TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  const Seen without = pushed(machine, 0.1);
  constexpr double kCompliance = 1e-8;

  const Seen with = pushed(machine, 0.1, {"load_compliance", "", {{"compliance", kCompliance}}});

  // u = r − χ K u; the static errors of the two machines may differ by the dead band's 2 mm.
  EXPECT_NEAR(with.displacement[0],
              without.displacement[0] / (1 + kCompliance * kSpecimenStiffness), 2e-3);
}

TEST(TestMachineTerms, OfTheMountActBetweenPlatenAndSpecimen) {
  const TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  constexpr double kFlexibility = 2e-8, kGap = 4e-3, kHalfWidth = 3e-3;

  const Seen soft =
      pushed(machine, 0.1, {"support_flexibility", "", {{"flexibility", kFlexibility}}});
  const Seen play = pushed(machine, 0.1, {"transducer_backlash", "", {{"gap", kGap}}});
  const Seen dead = pushed(machine, 0.1, {"input_dead_zone", "", {{"half_width", kHalfWidth}}});

  EXPECT_NEAR(soft.specimen_force[0],
              kSpecimenStiffness * soft.displacement[0] / (1 + kFlexibility * kSpecimenStiffness),
              100);
  EXPECT_LT(soft.specimen_force[0], 0.84 * kSpecimenStiffness * soft.displacement[0]);
  EXPECT_NEAR(dead.specimen_force[0], kSpecimenStiffness * (dead.displacement[0] - kHalfWidth), 1);
  // At rest the specimen may be anywhere within half the gap.
  EXPECT_LE(std::abs(play.specimen_force[0] - kSpecimenStiffness * play.displacement[0]),
            kSpecimenStiffness * kGap / 2 * (1 + 1e-9));
  EXPECT_GT(std::abs(play.specimen_force[0] - kSpecimenStiffness * play.displacement[0]),
            kSpecimenStiffness * kGap / 100);
}

TEST(TestMachineTerms, MayShareANameWithATermOfTheSpecimen) {
  const TermSettings friction{"coulomb_friction", "", {{"friction_force", 1e4}}};
  TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  machine.specimen.terms.push_back(friction);
  machine.specimen.terms.push_back({"input_dead_zone", "", {{"half_width", 1e-3}}});
  machine.terms = {friction, {"input_dead_zone", "", {{"half_width", 1e-3}}}};

  EXPECT_EQ(refusal(machine), "");
}

// A machine term adds to the table force, not to the specimen's force.
TEST(TestMachineTerms, OfTheMachineAddToTheTableForce) {
  constexpr double kFriction = 50e3;
  TestMachine machine = bare_machine(test::plain_lead_rubber());
  TestMachineRun bare{machine, kPeriod};
  machine.terms = {{"coulomb_friction", "", {{"friction_force", kFriction}, {"presliding", 1e-4}}}};
  TestMachineRun rough{machine, kPeriod};
  MachineFeedback without, with;
  for (int i = 0; i < 2000; ++i) {
    static_cast<void>(bare.step({0.05e-3 * i, 0}, kAxialLoad, without));
    static_cast<void>(rough.step({0.05e-3 * i, 0}, kAxialLoad, with));
  }

  // At 50 mm/s; each millimetre of difference in displacement changes the force by 4.2 kN.
  EXPECT_NEAR(with.force[0] - without.force[0], kFriction, 4e3);
  EXPECT_NEAR(rough.specimen_force()[0] - bare.specimen_force()[0], 0, 4e3);
}

TEST(TestMachineTerms, OfInertiaAddToThePlatensMass) {
  const TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  TestMachine heavy = machine;
  heavy.axes[0].effective_mass *= 3;
  TestMachine loaded = machine;
  loaded.terms.push_back(
      {"platen_inertia", "", {{"mass", 2 * machine.axes[0].effective_mass}}, 0b01});

  EXPECT_EQ(pushed(loaded, 0.1).displacement, pushed(heavy, 0.1).displacement);

  loaded.terms[0].parameters[0].second = -machine.axes[0].effective_mass;
  EXPECT_EQ(refusal(loaded),
            "test machine: effective_mass (with platen_inertia) is 0, expected a positive number");
}

TEST(TestMachineTerms, AreRefusedWhereTheirOwnerCannotHaveThem) {
  for (const char* kind : {"lead_heating", "bouc_wen", "elastomeric_axial"}) {
    TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
    machine.terms = {{kind, "", {}}};
    EXPECT_NE(refusal(machine).find("belongs to the specimen (stage"), std::string::npos) << kind;
  }
  for (const char* kind : {"gain", "actuator_delay"}) {
    Bearing specimen = linear_specimen(kSpecimenStiffness);
    specimen.terms.push_back({kind, "", {}});
    EXPECT_NE(refusal(bare_machine(specimen)).find("belongs to the machine (stage"),
              std::string::npos)
        << kind;
  }
}

// With the valve shut, leakage is the only damping: m ẍ + (k + k_o) x decays with λ/2 k_o/(k +
// k_o). k_o = 4 B A²/V is the stiffness of the oil and λ = 4 B C_l/V the rate of leakage; both
// rates are small against the frequency. Forces half a substep late would add −k h/(4 m), that is
// −0.22 1/s of 0.26 1/s for the stiffer specimen.
TEST(TestMachine, DecaysAtTheRateOfItsLeakage) {
  for (const double stiffness : {1e8, 1e9}) {
    TestMachine machine = bare_machine(linear_specimen(stiffness));
    ServoAxis& axis = machine.axes[0];
    axis.dead_band = 1;
    machine.terms = {{"cogging", "", {{"force", 1e5}, {"pitch", 10}, {"phase", 1.5}}}};
    TestMachineRun run{machine, kPeriod};
    MachineFeedback feedback;
    constexpr int kWindow = 1000, kWindows = 5;
    double largest[kWindows] = {};
    for (int i = 0; i < kWindows * kWindow; ++i) {
      static_cast<void>(run.step({0, 0}, kAxialLoad, feedback));
      double& peak = largest[i / kWindow];
      peak = std::max(peak, std::abs(feedback.acceleration[0]));
    }
    const double found = std::log(largest[1] / largest[4]) / 3;

    const double oil = 4 * axis.bulk_modulus / axis.oil_volume;
    const double oil_stiffness = oil * axis.piston_area * axis.piston_area;
    const double expected = oil * axis.leakage / 2 * oil_stiffness / (stiffness + oil_stiffness);
    // Peaks of an oscillation of 20 Hz, sampled every 1 ms.
    EXPECT_NEAR(found, expected, 0.02 * expected) << stiffness;
  }
}

TEST(TestMachine, RefusesRatesTooFastForItsSubsteps) {
  TestMachine machine = bare_machine(linear_specimen(1e12));
  EXPECT_NE(refusal(machine).find("the rate of the specimen on the platen"), std::string::npos);

  machine = bare_machine(linear_specimen(kSpecimenStiffness));
  machine.axes[0].valve_frequency = 5000;
  EXPECT_NE(refusal(machine).find("the rate of the spool"), std::string::npos);

  machine = bare_machine(linear_specimen(kSpecimenStiffness));
  machine.axes[0].effective_mass = 1;
  EXPECT_NE(refusal(machine).find("the rate of the oil column"), std::string::npos);
}

TEST(TestMachine, RefusesParametersOutOfRange) {
  const auto with = [](double ServoAxis::*member, double value) {
    TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
    machine.axes[1].*member = value;
    return refusal(machine);
  };
  EXPECT_EQ(with(&ServoAxis::dead_band, -1), "test machine: dead_band is -1, expected 0 to 1");
  EXPECT_EQ(with(&ServoAxis::valve_damping, -2),
            "test machine: valve_damping is -2, expected 0 to 10");
  EXPECT_EQ(with(&ServoAxis::leakage, -1e-10),
            "test machine: leakage is -1e-10, expected 0 or more");
  EXPECT_NE(with(&ServoAxis::force_offset, std::nan("")).find("force_offset is nan"),
            std::string::npos);
  TestMachine machine = bare_machine(linear_specimen(kSpecimenStiffness));
  machine.noise.force = -1;
  EXPECT_EQ(refusal(machine), "test machine: force_noise is -1, expected 0 or more");
}

}  // namespace
}  // namespace rths::sim
