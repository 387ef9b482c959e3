// SPDX-License-Identifier: Apache-2.0
//
// The demo's hybrid test, short, with its native nodes or with others in their place.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"

namespace rths::test {

using experiment::Overrides;

inline std::string example() { return (source_tree() / "examples/srmd_lprb_2d.toml").string(); }
inline std::string quoted(const std::string& text) { return "\"" + text + "\""; }

inline const Overrides kShort{{"duration_s", "2"}, {"rest_s", "0"}};

/// A native node of the example as a plugin.
inline Overrides as_plugin(const std::string& node, const std::string& role, bool own_process) {
  const std::string key = "node." + node + ".";
  return {{key + "adapter", quoted("plugin")},
          {key + "library", quoted((build_tree() / "lib/rths/librths_native.so").string())},
          {key + "role", quoted(role)},
          {key + "own_process", own_process ? "true" : "false"},
          {key + "config.experiment", quoted(example())},
          {key + "config.node", quoted(node)}};
}

/// The example without the keys of its controller that a plugin does not have.
inline std::filesystem::path example_in(const TemporaryFolder& folder) {
  std::string text = content_of(example());
  const auto begin = text.find("diagram = "), end = text.find("\n\n", begin) + 1;
  text.erase(begin, end - begin);
  const std::string head = "format = 1\n";
  text.insert(text.find(head), "folder = " + quoted((source_tree() / "examples").string()) + "\n");
  return folder.write("plugin.toml", text);
}

inline experiment::Experiment experiment_with(const std::filesystem::path& file,
                                              const Overrides& changes) {
  Overrides all = kShort;
  all.insert(all.end(), changes.begin(), changes.end());
  return app::load_experiment(file, all);
}

inline recording::Reader run_virtually(const experiment::Experiment& experiment,
                                       const std::filesystem::path& file) {
  launch::RunOptions options;
  options.clock = launch::ClockKind::Virtual;
  options.recording = file;
  const auto outcome = launch::run(experiment, options);
  EXPECT_TRUE(outcome.completed) << outcome.trouble;
  return recording::Reader{file};
}

/// Expects that a run has the signals of another, equal to 1e-9 of the largest value.
/// @param until  the run is compared to this time [s]
inline void expect_same(const recording::Reader& native, const recording::Reader& other,
                        const std::string& title, double until = 1e9) {
  for (const auto& name : native.names()) {
    // The host of a plugin ramps to rest; its safety layer does not see the end.
    if (name == "monitor.srmd.safety.state") continue;
    ASSERT_TRUE(other.has(name)) << title << ": " << name;
    const auto expected = native.signal(name), found = other.signal(name);
    double largest = 0, difference = 0;
    for (std::size_t i = 0; i < expected.size() && native.time()[i] <= until; ++i) {
      ASSERT_LT(i, found.size()) << title;
      largest = std::max(largest, std::abs(expected[i]));
      difference = std::max(difference, std::abs(expected[i] - found[i]));
    }
    EXPECT_LE(difference, 1e-9 * largest) << title << ": " << name;
  }
}

/// The least mean of a hundred steps, since other programs only add to it.
inline double microseconds_per_step(adapters::Adapter& adapter) {
  constexpr int kBatches = 20, kSteps = 100;
  adapter.activate();
  Bench bench{adapter};
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

/// Cost of a tick of the controller of an experiment [us].
inline double cost_of_controller(const experiment::Experiment& experiment) {
  const auto map = memmap::load_map(source_tree() / "memmap/maps/srmd.ringmap.toml");
  for (const auto& plan : experiment.nodes)
    if (plan.node == "xpc")
      return microseconds_per_step(*plan.settings.make(
          experiment, {"xpc", plan.schedule.period, true, {}, map, {}, {}, {}, {}}));
  return 0;
}

}  // namespace rths::test
