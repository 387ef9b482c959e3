// SPDX-License-Identifier: Apache-2.0
//
// Plugins in a hybrid test: the native controller and machine through the interface of plugins give
// the same test, and a broken plugin ends it safely.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

namespace rths::plugin {
namespace {

using launch::Overrides;

std::string example() { return (test::source_tree() / "examples/srmd_lprb_2d.toml").string(); }
std::string quoted(const std::string& text) { return "\"" + text + "\""; }

const Overrides kShort{{"duration_s", "2"}, {"rest_s", "0"}};

/// A native node of the example as a plugin.
Overrides as_plugin(const std::string& node, const std::string& role, bool own_process) {
  const std::string key = "node." + node + ".";
  return {{key + "adapter", quoted("plugin")},
          {key + "library", quoted((test::build_tree() / "lib/rths/librths_native.so").string())},
          {key + "role", quoted(role)},
          {key + "own_process", own_process ? "true" : "false"},
          {key + "config.experiment", quoted(example())},
          {key + "config.node", quoted(node)}};
}

/// The example without the keys of its controller that a plugin does not have.
std::filesystem::path example_in(const test::TemporaryFolder& folder) {
  std::string text = test::content_of(example());
  const auto begin = text.find("diagram = "), end = text.find("\n\n", begin) + 1;
  text.erase(begin, end - begin);
  const std::string head = "format = 1\n";
  text.insert(text.find(head),
              "folder = " + quoted((test::source_tree() / "examples").string()) + "\n");
  return folder.write("plugin.toml", text);
}

launch::Experiment experiment_with(const std::filesystem::path& file, const Overrides& changes) {
  Overrides all = kShort;
  all.insert(all.end(), changes.begin(), changes.end());
  return app::load_experiment(file, all);
}

recording::Reader run(const launch::Experiment& experiment, const std::filesystem::path& file) {
  launch::RunOptions options;
  options.clock = launch::ClockKind::Virtual;
  options.recording = file;
  const auto outcome = launch::run(experiment, options);
  EXPECT_TRUE(outcome.completed) << outcome.trouble;
  return recording::Reader{file};
}

TEST(PluginRun, OfTheNativeControllerAndMachineEqualsTheNativeRun) {
  const test::TemporaryFolder folder;
  const auto native = run(experiment_with(example(), {}), folder.path() / "native.h5");
  const auto plugins = example_in(folder);

  for (const bool own_process : {false, true}) {
    Overrides changes = as_plugin("xpc", "controller", own_process);
    const auto machine = as_plugin("srmd", "machine", own_process);
    changes.insert(changes.end(), machine.begin(), machine.end());
    const auto plugin = run(experiment_with(plugins, changes),
                            folder.path() / (own_process ? "own_process.h5" : "in_process.h5"));
    ASSERT_EQ(plugin.names(), native.names());
    for (const auto& name : native.names()) {
      const auto expected = native.signal(name), found = plugin.signal(name);
      ASSERT_EQ(expected.size(), found.size());
      double largest = 0, difference = 0;
      for (std::size_t i = 0; i < expected.size(); ++i) {
        largest = std::max(largest, std::abs(expected[i]));
        difference = std::max(difference, std::abs(expected[i] - found[i]));
      }
      EXPECT_LE(difference, 1e-9 * largest) << name << (own_process ? ", own process" : "");
    }
  }
}

/// The least mean of a hundred steps, since other programs only add to it.
double microseconds_per_step(adapters::Adapter& adapter) {
  constexpr int kBatches = 20, kSteps = 100;
  adapter.activate();
  test::Bench bench{adapter};
  double least = 1e9;
  for (int batch = 0; batch < kBatches; ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kSteps; ++i) static_cast<void>(bench.step(0.001 * (batch * kSteps + i)));
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begin;
    least = std::min(least, spent.count() / kSteps * 1e6);
  }
  adapter.deactivate();
  return least;
}

// A figure, not a limit: the host may be busy.
TEST(PluginRun, PrintsTheCostOfATick) {
  const test::TemporaryFolder folder;
  const auto plugins = example_in(folder);
  const auto map = memmap::load_map(test::source_tree() / "memmap/maps/srmd.ringmap.toml");
  const auto cost = [&](const launch::Experiment& experiment) {
    for (const auto& plan : experiment.nodes)
      if (plan.node == "xpc")
        return microseconds_per_step(*plan.settings.make(
            experiment, {"xpc", plan.schedule.period, true, {}, map, {}, {}, {}}));
    return 0.0;
  };
  const double native = cost(experiment_with(example(), {}));
  const double in_process = cost(experiment_with(plugins, as_plugin("xpc", "controller", false)));
  const double own_process = cost(experiment_with(plugins, as_plugin("xpc", "controller", true)));

  std::printf(
      "cost per tick of the controller: native %.2f us, plugin %.2f us, in its own process "
      "%.2f us\n",
      native, in_process, own_process);
  EXPECT_GT(native, 0);
  EXPECT_GT(in_process, 0);
  EXPECT_GT(own_process, 0);
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
  expect("step_allocates_later", "its step used the heap 2 times");
  expect("step_leaves_its_range", "its step wrote 1.5 to 'srmd.long.displ.fbk'");
  expect("step_crashes", "its step crashed: Segmentation fault at 0.100 s", "own_process = true\n");
}

TEST(PluginRun, EndsSafelyInRealTimeWhenAPluginLoopsForEver) {
  const test::TemporaryFolder folder;
  expect_safe_end(folder, run_with(folder, "step_loops", "wall"),
                  "srmd: plugin 'lag' (step_loops.so): its step did not return within 0.3 s");
}

TEST(PluginRun, SaysWhichKeyOfItsTableIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = example_in(folder);
  const auto error_with = [&](const std::string& key, const std::string& value) {
    Overrides changes = as_plugin("xpc", "controller", false);
    changes.emplace_back("node.xpc." + key, value);
    return test::error_of([&] { static_cast<void>(experiment_with(file, changes)); });
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

TEST(PluginRun, IsRefusedIfThePluginStatesAnotherUnitThanTheMap) {
  const test::TemporaryFolder folder;
  const auto run = run_with(folder, "unit_unknown", "virtual");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("furlongish"), std::string::npos) << run.err;
}

}  // namespace
}  // namespace rths::plugin
