// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/launch/experiment.hpp>
#include <rths/launch/run.hpp>

#include "support/files.hpp"

namespace rths::launch {
namespace {

/// An experiment beside its record, in a folder of its own.
class ExperimentTest : public ::testing::Test {
 protected:
  ExperimentTest() {
    folder.write("record.csv", "0.00,0.1,0.2\n0.02,0.3,-0.1\n0.04,0,0\n");
    std::filesystem::copy_file(
        test::source_tree() / "adapters/simulink_like/diagrams/hybrid_controller.toml",
        folder.path() / "controller.toml");
    std::filesystem::copy_file(test::source_tree() / "memmap/maps/srmd.ringmap.toml",
                               folder.path() / "lab.ringmap.toml");
  }

  [[nodiscard]] std::filesystem::path write(const std::string& from = "",
                                            const std::string& to = "") const {
    std::string text = kText;
    if (!from.empty()) {
      EXPECT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    }
    return folder.write("lab.toml", text);
  }
  [[nodiscard]] std::string error_with(const std::string& from, const std::string& to) const {
    const auto file = write(from, to);
    std::string error = test::error_of([&] { check_assembly(load_experiment(file)); });
    const std::string prefix = folder.path().string() + "/";
    for (auto at = error.find(prefix); at != std::string::npos; at = error.find(prefix))
      error.erase(at, prefix.size());
    return error;
  }

  test::TemporaryFolder folder;
  static constexpr const char* kText = R"(format = 1
name = "lab"
map = "lab.ringmap.toml"
duration_s = 2.0
seed = 7
[motion]
file = "record.csv"
scale = 2.0
[node.recorder]
adapter = "recorder"
[node.opf]
adapter = "numerical"
[node.srmd]
adapter = "srmd"
[node.xpc]
adapter = "simulink_like"
diagram = "controller.toml"
tune.ats.enabled = 0
[uncompensated.xpc]
ats.enabled = 0
)";
};

TEST_F(ExperimentTest, IsReadWithItsDefaults) {
  const Experiment e = load_experiment(write());

  EXPECT_EQ(e.name, "lab");
  EXPECT_EQ(e.axes, (std::vector<std::string>{"long", "lat"}));
  EXPECT_EQ(e.integration_step, 0.01);
  EXPECT_EQ(e.simulation_step(), 0.01);
  EXPECT_EQ(e.machine.seed, 7U);
  EXPECT_NEAR(e.motion.long_acceleration[1], 0.3 * 2 * 9.80665, 1e-12);
  EXPECT_NEAR(e.motion.lat_acceleration[1], -0.1 * 2 * 9.80665, 1e-12);
  EXPECT_EQ(e.config.size(), 3U);  // with the bearing and the diagram
  EXPECT_NEAR(e.specimen.axial_load, 480e6 * 9.80665 / 486, 1);
}

TEST_F(ExperimentTest, ChangesABearingTermByTerm) {
  const Experiment plain = load_experiment(write());
  const Experiment changed =
      load_experiment(write(), {{"specimen.bouc_wen.characteristic_strength_N", "5e5"},
                                {"specimen.coulomb_friction.friction_force_N", "1e4"}});

  EXPECT_EQ(changed.specimen.terms.size(), plain.specimen.terms.size() + 1);
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(load_experiment(write(), {{"specimen.model", "\"lprc\""}}));
            }).find("model is 'lprc', expected a file or one of:") == std::string::npos,
            false);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(load_experiment(write(), {{"specimen.modl", "\"lprb\""}}));
            }).find("unknown key 'modl' (did you mean 'model'?)"),
            std::string::npos);
}

TEST_F(ExperimentTest, SaysWhereATermMeansNothing) {
  const auto error = [&](const std::string& key) {
    return test::error_of([&] { static_cast<void>(load_experiment(write(), {{key, "1.1"}})); });
  };
  EXPECT_EQ(error("machine.adiabatic_heating.cooling_time_s"),
            "--set machine.adiabatic_heating.cooling_time_s: term 'adiabatic_heating' is of the "
            "specimen (stage modifier), expected one of the stages actuator, motion, machine or "
            "sensor");
  EXPECT_EQ(
      error("specimen.gain.factor"),
      "--set specimen.gain.factor: term 'gain' is of the machine (stage sensor); a specimen has "
      "none of it");
}

TEST_F(ExperimentTest, StartsListenersBeforeSpeakers) {
  const Experiment e = load_experiment(write());

  std::vector<std::string> order;
  for (const auto& node : e.nodes) order.push_back(node.node);
  EXPECT_EQ(order, (std::vector<std::string>{"recorder", "srmd", "xpc", "opf"}));
}

TEST_F(ExperimentTest, ReadsTuningWithDottedNames) {
  const Experiment e = load_experiment(write());

  EXPECT_EQ(e.nodes[2].tune, (Tuning{{"ats.enabled", 0}}));
  EXPECT_EQ(e.nodes[2].uncompensated, (Tuning{{"ats.enabled", 0}}));
}

TEST_F(ExperimentTest, TakesChangesFromTheCommandLine) {
  const Experiment e = load_experiment(write(), {{"duration_s", "5"}, {"motion.scale", "1"}});

  EXPECT_EQ(e.duration, 5);
  EXPECT_NEAR(e.motion.long_acceleration[1], 0.3 * 9.80665, 1e-12);
}

TEST_F(ExperimentTest, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(error_with("format = 1", "format = 9"),
            "lab.toml:1:10: format is 9, this program reads 1");
  EXPECT_EQ(error_with("duration_s", "duration"),
            "lab.toml:4:12: unknown key 'duration' (did you mean 'duration_s'?)");
  EXPECT_EQ(error_with("seed = 7", "sed = 7"),
            "lab.toml:5:7: unknown key 'sed' (did you mean 'seed'?)");
  EXPECT_EQ(error_with("seed = 7", "axes = [\"up\"]"),
            "lab.toml:5:8: axes must be [\"long\"], [\"lat\"] or both");
  EXPECT_EQ(error_with("seed = 7", "rate = 0.5"), "lab.toml:5:8: rate is 0.5, expected 1 to 1000");
  EXPECT_EQ(error_with("\"srmd\"\n[node.xpc]", "\"smrd\"\n[node.xpc]"),
            "lab.toml:14:11: there is no adapter 'smrd', expected one of recorder, srmd, "
            "simulink_like, numerical");
  EXPECT_EQ(error_with("record.csv", "records.csv"), "records.csv: cannot be read");
  EXPECT_NE(error_with("\"controller.toml\"", "\"none.toml\"")
                .find("lab.toml:17:11: diagram is 'none.toml', expected a file or one of:"),
            std::string::npos);
  EXPECT_EQ(error_with("[uncompensated.xpc]", "[uncompensated.xcp]"),
            "lab.toml:19:1: [uncompensated] names node 'xcp', which does not take part");
}

TEST_F(ExperimentTest, RefusesToTuneWhatIsNotThere) {
  EXPECT_EQ(error_with("tune.ats.enabled", "tune.ats.enable"),
            "node 'xpc' has no parameter 'ats.enable' (did you mean 'ats.enabled'?)");
}

TEST_F(ExperimentTest, RefusesANodeThatWritesAnothersWords) {
  EXPECT_EQ(error_with("[node.srmd]\nadapter = \"srmd\"", "[node.machine]\nadapter = \"srmd\""),
            "");
}

}  // namespace
}  // namespace rths::launch
