// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/sim/machine/platen_run.hpp>

#include "srmd_file.hpp"
#include "support/period.hpp"

namespace rths::sim::machine {
namespace {

Config srmd_file() { return Config::load(test::source_tree() / "sim/machines/srmd.toml"); }

std::string refusal(const std::string& key, const std::string& value) {
  Config file = srmd_file();
  file.set(key, value);
  return test::error_of([&] { static_cast<void>(read_platen_machine(file)); });
}

TEST(PlatenFile, RefusesWrongValues) {
  EXPECT_NE(refusal("platen.mass_kg", "[1, 2]").find("mass_kg has 2 numbers, expected 3"),
            std::string::npos);
  EXPECT_NE(refusal("platen.mass_kg", "[1, 2, -3]").find("mass_kg holds -3"), std::string::npos);
  EXPECT_NE(refusal("geometry.foot_m", "[[1, 2]]").find("expected 4 points of 2 numbers"),
            std::string::npos);
  EXPECT_NE(refusal("actuator_long.dead_bnd", "1").find("unknown key 'dead_bnd'"),
            std::string::npos);
  EXPECT_NE(refusal("machine", "2").find("format of the machine is 2"), std::string::npos);
}

TEST(PlatenMachine, RefusesActuatorsThatDoNotReach) {
  PlatenMachine m = test::srmd_machine_file();
  m.along_lat.stroke = 0.5;

  EXPECT_NE(
      test::error_of([&] { PlatenRun(m, test::kPeriod); }).find("horizontal actuator 3 moves"),
      std::string::npos);
}

TEST(PlatenMachine, RefusesModesTooFastForItsSubsteps) {
  PlatenMachine m = test::srmd_machine_with_bearing();
  m.vertical_specimen.stiffness = 1e12;

  EXPECT_NE(test::error_of([&] { PlatenRun(m, test::kPeriod); }).find("the specimen's compression"),
            std::string::npos);
}

TEST(PlatenFamily, StartsWithTheNominalMachine) {
  const PlatenMachine nominal = test::srmd_machine_file();
  const FamilyMember member = family_member(nominal, 0);

  EXPECT_EQ(member.machine.supply.bulk_modulus, nominal.supply.bulk_modulus);
  EXPECT_EQ(member.specimen_stiffness, 1);
}

// Uniform draws: the mean of 200 is within 4 standard deviations, width/√(12·200), of the middle.
TEST(PlatenFamily, CoversTheStatedRanges) {
  const PlatenMachine nominal = test::srmd_machine_file();
  struct Range {
    double low, high, sum = 0;
    void add(double value) {
      EXPECT_GE(value, low);
      EXPECT_LE(value, high);
      sum += value;
    }
    ~Range() {
      EXPECT_NEAR(sum / kFamilySize, (low + high) / 2,
                  4 * (high - low) / std::sqrt(12.0 * kFamilySize));
    }
  };
  Range bulk{0.8, 1.2}, valve{0.85, 1.15}, dead_band{0.005, 0.02}, friction{0.5, 1.5},
      stiffness{0.7, 1.3};
  for (int i = 1; i <= kFamilySize; ++i) {
    const FamilyMember member = family_member(nominal, i);
    const PlatenMachine& m = member.machine;
    bulk.add(m.supply.bulk_modulus / nominal.supply.bulk_modulus);
    valve.add(m.along_lat.valve_frequency / nominal.along_lat.valve_frequency);
    dead_band.add(m.along_long.dead_band);
    friction.add(m.friction.coefficient / nominal.friction.coefficient);
    stiffness.add(member.specimen_stiffness);
  }
}

TEST(PlatenFamily, IsFixedByItsIndex) {
  const PlatenMachine nominal = test::srmd_machine_file();

  EXPECT_EQ(family_member(nominal, 7).machine.supply.bulk_modulus,
            family_member(nominal, 7).machine.supply.bulk_modulus);
  EXPECT_EQ(test::error_of([&] { static_cast<void>(family_member(nominal, 201)); }),
            "machine: member 201 of the family, expected 0 to 200");
}

TEST(PlatenFamily, ScalesTheSpecimensStiffness) {
  const Bearing bearing = with_stiffness(test::plain_lead_rubber(), 1.3);

  EXPECT_NEAR(largest_stiffness(bearing),
              1.3 * (test::kStrength / test::kYieldDisplacement + test::kPostYieldStiffness),
              0.01 * 1.3 * test::kInitialStiffness);
}

}  // namespace
}  // namespace rths::sim::machine
