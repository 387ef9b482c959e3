// SPDX-License-Identifier: Apache-2.0
//
// Plugins in a hybrid test: the native controller and machine through the interface of plugins give
// the same test, and a broken plugin ends it safely.
#include <gtest/gtest.h>

#include <rths/core/config.hpp>
#include <rths/core/sha256.hpp>

#include "plugin/native_runs.hpp"
#include "support/process.hpp"
#include "support/realtime_guard.hpp"

namespace rths::plugin {
namespace {

using experiment::Overrides;

TEST(PluginRun, OfTheNativeControllerAndMachineEqualsTheNativeRun) {
  const test::TemporaryFolder folder;
  const auto native =
      test::run_virtually(test::experiment_with(test::example(), {}), folder.path() / "native.h5");
  const auto plugins = test::example_in(folder);

  for (const bool own_process : {false, true}) {
    Overrides changes = test::as_plugin("xpc", "controller", own_process);
    const auto machine = test::as_plugin("srmd", "machine", own_process);
    changes.insert(changes.end(), machine.begin(), machine.end());
    const auto plugin =
        test::run_virtually(test::experiment_with(plugins, changes),
                            folder.path() / (own_process ? "own_process.h5" : "in_process.h5"));
    EXPECT_EQ(plugin.names(), native.names());
    EXPECT_EQ(plugin.rows(), native.rows());
    test::expect_same(native, plugin, own_process ? "own process" : "in process");
  }
}

/// Runs the example with a broken adapter as its machine.
test::Finished run_with(const test::TemporaryFolder& folder, const std::string& name,
                        const std::string& clock, const std::string& extra = "") {
  const std::string text = R"(format = 1
name = "broken_plugin"
map = "srmd"
folder = ")" + (test::source_tree() / "examples").string() +
                           R"("
duration_s = 5
[motion]
file = "records/petrolia_1992_riodell_freefield.csv"
[node.srmd]
adapter = "plugin"
role = "machine"
library = ")" + (test::build_tree() / "broken" / (name + ".so")).string() +
                           "\"\n" + extra + R"([node.xpc]
adapter = "simulink_like"
diagram = "hybrid_controller"
[node.opf]
adapter = "numerical"
[node.recorder]
adapter = "recorder"
)";
  const auto file = folder.write("broken.toml", text);
  return test::run_rths(
      {"run", file.string(), "--clock", clock, "--no-diagnosis", "--out",
       (folder.path() / "out").string(), "--force", "--ring", "broken_plugin_" + name},
      60);
}

TEST(PluginRun, NamesThePluginAndItsHashInTheRecording) {
  const test::TemporaryFolder folder;
  const auto run = run_with(folder, "correct", "virtual");

  const recording::Reader recording{folder.path() / "out" / "run.h5"};
  const auto identity = Config::parse(recording.config("srmd.plugin"), "srmd.plugin");
  EXPECT_EQ(identity.text("file"), "correct.so") << run.err;
  EXPECT_EQ(identity.text("sha256"), sha256_of(test::build_tree() / "broken/correct.so"));
}

void expect_safe_end(const test::TemporaryFolder& folder, const test::Finished& run,
                     const std::string& line) {
  EXPECT_EQ(run.exit_code, 2) << run.err;
  EXPECT_NE(run.err.find(line), std::string::npos) << run.err;
  const recording::Reader recording{folder.path() / "out" / "run.h5"};
  EXPECT_GT(recording.rows(), 90U);
}

TEST(PluginRun, EndsSafelyInVirtualTimeWhenAPluginIsBroken) {
  const test::TemporaryFolder folder;
  const auto expect = [&](const std::string& name, const std::string& reason,
                          const std::string& extra = "") {
    expect_safe_end(folder, run_with(folder, name, "virtual", extra),
                    "the run ended early: srmd: plugin 'lag' (" + name + ".so): " + reason);
  };
  expect("step_crashes", "its step crashed: Segmentation fault at 0.100 s");
  expect("step_loops", "its step did not return within 0.5 s at 0.100 s", "deadline_s = 0.5\n");
  expect("step_writes_nan", "its step wrote nan to 'srmd.long.displ.fbk'");
  if (test::RealTimeGuard::supported())
    expect("step_allocates_later", "its step used the heap 2 times");
  expect("step_leaves_its_range", "its step wrote 1.5 to 'srmd.long.displ.fbk'");
  expect("step_crashes", "its step crashed: Segmentation fault at 0.100 s", "own_process = true\n");
  expect("step_sets_nothing",
         "its steps set none of its 2 outputs, such as 'srmd.long.displ.fbk', for 2 s at 2.000 s");
}

TEST(PluginRun, EndsSafelyInRealTimeWhenAPluginLoopsForEver) {
  const test::TemporaryFolder folder;
  expect_safe_end(folder, run_with(folder, "step_loops", "wall"),
                  "srmd: plugin 'lag' (step_loops.so): its step did not return within 0.3 s");
}

TEST(PluginRun, SaysWhichKeyOfItsTableIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = test::example_in(folder);
  const auto error_with = [&](const std::string& key, const std::string& value) {
    Overrides changes = test::as_plugin("xpc", "controller", false);
    changes.emplace_back("node.xpc." + key, value);
    return test::error_of([&] { static_cast<void>(test::experiment_with(file, changes)); });
  };
  const auto has = [](const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(error_with("role", "\"observer\""),
                  "role is 'observer', expected machine, controller or solver"));
  EXPECT_TRUE(
      has(error_with("library", "\"/no/such.so\""), "library is '/no/such.so', expected a file"));
  EXPECT_TRUE(has(error_with("own_proces", "true"), "did you mean 'own_process'?"));
}

// The table of the layer belongs to machines, and a machine must have the words that it guards.
TEST(PluginRun, HasASafetyLayerOnlyInFrontOfAMachineWithItsWords) {
  const test::TemporaryFolder folder;
  const auto file = test::example_in(folder);
  Overrides controller = test::as_plugin("xpc", "controller", false);
  controller.emplace_back("node.xpc.safety.watchdog_s", "0.5");
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(test::experiment_with(file, controller));
            }).find("unknown key 'safety'"),
            std::string::npos);

  const auto run = run_with(folder, "correct", "virtual", "[node.srmd.safety]\n");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("safety: the machine has no word 'srmd.long.force.fbk'"),
            std::string::npos)
      << run.err;
}

TEST(PluginRun, IsRefusedIfThePluginStatesAnotherUnitThanSi) {
  const test::TemporaryFolder folder;
  const auto run = run_with(folder, "unit_unknown", "virtual");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("furlongish"), std::string::npos) << run.err;
  const std::string line =
      "rths: node 'srmd' writes 'srmd.long.displ.fbk' in [mm], expected the SI unit [m]\n";
  const auto scaled = run_with(folder, "unit_not_si", "virtual");
  EXPECT_NE(scaled.err.find(line), std::string::npos) << scaled.err;
}

}  // namespace
}  // namespace rths::plugin
