// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/core/config.hpp>
#include <rths/experiment/machine_table.hpp>

#include "support/files.hpp"

namespace rths::experiment {
namespace {

TEST(MachineConfig, SetsBothAxes) {
  const auto machine =
      read_machine(Config::parse("dead_band = [0.01, 0.02]\nempty_table = true", "m.toml"));

  EXPECT_EQ(machine.axes[0].dead_band, 0.01);
  EXPECT_EQ(machine.axes[1].dead_band, 0.02);
  EXPECT_FALSE(machine.has_specimen);
}

TEST(MachineConfig, PutsRollersOnAnEmptyTableOnly) {
  EXPECT_TRUE(
      read_machine(Config::parse("empty_table = true\nrollers = true", "m.toml")).has_rollers);
  EXPECT_EQ(
      test::error_of(
          [] { static_cast<void>(read_machine(Config::parse("rollers = true", "m.toml"))); }),
      "m.toml:1:11: rollers is true, but empty_table is false: a table carries either rollers or a "
      "specimen");
}

TEST(MachineConfig, SaysWhatIsWrong) {
  EXPECT_EQ(test::error_of([] {
              static_cast<void>(read_machine(Config::parse("dead_band = [1]", "m.toml")));
            }),
            "m.toml:1:13: dead_band has 1 numbers, expected [long, lat]");
  EXPECT_EQ(test::error_of([] {
              static_cast<void>(read_machine(Config::parse("dead_bnd = [1, 2]", "m.toml")));
            }),
            "m.toml:1:12: unknown key 'dead_bnd' (did you mean 'dead_band'?)");
}

TEST(MachineConfig, LaysTermsOverThoseOfTheSrmd) {
  const auto machine = read_machine(Config::parse(
      "[coulomb_friction]\nfriction_force_N = [6000, 7000]\n[viscous_friction]\nenabled = false",
      "m.toml"));

  ASSERT_EQ(machine.terms.size(), 2U);
  EXPECT_EQ(machine.terms[0].name, "coulomb_friction.long");
  EXPECT_EQ(machine.terms[0].parameters[0].second, 6000);
  EXPECT_EQ(machine.terms[1].parameters[0].second, 7000);
}

}  // namespace
}  // namespace rths::experiment
