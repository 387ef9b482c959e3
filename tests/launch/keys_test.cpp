// SPDX-License-Identifier: Apache-2.0
//
// Keys without an effect on the experiment are refused or remarked.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>

#include "support/files.hpp"

namespace rths::launch {
namespace {

/// A key that is added to an example, and a part of the message that refuses it.
struct Refused {
  const char* example;
  std::vector<std::string> sets;
  const char* message;
};

TEST(Keys, ThatNoNodeUsesAreRefusedByNameBeforeTheStart) {
  const Refused cases[] = {
      {"srmd_platen_2d", {"machine.gain.factor=1.1"}, "machine.gain has no effect"},
      {"srmd_platen_2d", {"machine.actuator_delay.delay_s=0.01"}, "machine.actuator_delay has no"},
      {"srmd_platen_2d",
       {"machine.coulomb_friction.friction_force_N=[1.0,1.0]"},
       "machine.coulomb_friction has no effect"},
      {"srmd_platen_2d", {"machine.force_noise_N=1e5"}, "machine.force_noise_N has no effect"},
      {"srmd_platen_2d", {"machine.position_gain_per_s=[10,10]"}, "machine.position_gain_per_s"},
      {"srmd_eqsb_3d", {"solver.overrun_s=0.1"}, "solver.overrun_s has no effect"},
      {"srmd_eqsb_2d",
       {"solver.overrun_fraction=0.0", "solver.overrun_s=0.01"},
       "solver.overrun_s has no effect"},
      {"srmd_eqsb_2d", {"plant.vertical_frequency_Hz=5"}, "plant.vertical_frequency_Hz has no"},
      {"srmd_eqsb_2d", {"network.domain=3"}, "network.domain has no effect"},
      {"opensees/one_bay_frame", {"machine.force_noise_N=1e5"}, "machine.force_noise_N has no"},
      {"opensees/one_bay_frame", {"solver.alpha=-0.1"}, "solver.alpha has no effect"},
      {"opensees/one_bay_frame", {"solver.substeps=2"}, "solver.substeps has no effect"},
  };
  for (const auto& one : cases) {
    const auto file = test::source_tree() / "examples" / (std::string{one.example} + ".toml");
    Overrides changes;
    for (const auto& set : one.sets)
      changes.emplace_back(set.substr(0, set.find('=')), set.substr(set.find('=') + 1));
    const auto error =
        test::error_of([&] { static_cast<void>(app::load_experiment(file, changes)); });
    EXPECT_NE(error.find(one.message), std::string::npos) << one.sets[0] << ": " << error;
    EXPECT_TRUE(error.starts_with("--set")) << error;
  }
}

// A machine of the user's own has no parameters here, but the diagnosis has a model of it.
TEST(Keys, OfAMachineOfTheUsersOwnAreSaidToChangeTheModelOnly) {
  const auto experiment = app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml",
                                               {{"node.srmd.adapter", "external"}});
  ASSERT_EQ(experiment.remarks.size(), 1U);
  EXPECT_NE(experiment.remarks[0].find("only the model in the diagnosis"), std::string::npos);
}

TEST(Keys, OfTheOtherAxisAreSaidToHaveNoEffectOnATestAlongOne) {
  const auto experiment = app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml",
                                               {{"axes", "[\"lat\"]"}});
  EXPECT_EQ(experiment.remarks,
            std::vector<std::string>{"without an effect on a test along lat: motion.column_long"});
}

TEST(Keys, OfTheSeedIsSaidToHaveNoEffectWithoutNoise) {
  const auto file = test::source_tree() / "examples/opensees/one_bay_frame.toml";
  const auto experiment = app::load_experiment(file, {{"seed", "7"}});
  ASSERT_EQ(experiment.remarks.size(), 1U);
  EXPECT_TRUE(experiment.remarks[0].starts_with("without an effect: seed"));
  EXPECT_TRUE(app::load_experiment(file, {}).remarks.empty());
}

TEST(Keys, OfTheEarthquakeAreSaidToHaveNoEffectOnCommandedDisplacements) {
  const auto experiment = app::load_experiment(test::source_tree() / "examples/srmd_platen_2d.toml",
                                               {{"targets.kind", "response"}});
  ASSERT_EQ(experiment.remarks.size(), 1U);
  EXPECT_NE(experiment.remarks[0].find("held_out"), std::string::npos);
  EXPECT_EQ(experiment.remarks[0].find("motion"), std::string::npos);
}

}  // namespace
}  // namespace rths::launch
