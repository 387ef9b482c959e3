// SPDX-License-Identifier: Apache-2.0
//
// Nodes that repeat a recorded run, beside live ones, in virtual time.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/report/comparison.hpp>

#include "support/files.hpp"

namespace rths::session {
namespace {

using experiment::Overrides;

class ReplayedVirtualRun : public ::testing::Test {
 protected:
  // The test alone, without companions.
  std::filesystem::path made(const std::string& name, const Overrides& changes,
                             const decltype(launch::RunOptions::lateness)& lateness = {}) {
    Overrides all{{"duration_s", "2"}, {"rest_s", "0.5"}};
    all.insert(all.end(), changes.begin(), changes.end());
    launch::RunOptions options;
    options.clock = launch::ClockKind::Virtual;
    options.lateness = lateness;
    options.recording = temporary_.path() / (name + ".h5");
    options.overrides = all;
    const auto experiment =
        app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml", all);
    EXPECT_TRUE(launch::run(experiment, options).completed);
    return options.recording;
  }
  static Overrides replayed(const std::string& node, const std::string& role,
                            const std::filesystem::path& recording) {
    return {{"node." + node + ".adapter", "replay"},
            {"node." + node + ".role", role},
            {"node." + node + ".recording", recording.string()}};
  }
  static report::ComparedRuns compared(const std::filesystem::path& a,
                                       const std::filesystem::path& b,
                                       const std::vector<std::string>& patterns) {
    report::ComparisonSettings settings;
    settings.patterns = patterns;
    settings.tolerance = report::Tolerance{};
    return report::compare(a, b, settings);
  }
  static const report::ComparedSignal& signal_of(const report::ComparedRuns& runs,
                                                 const std::string& name) {
    return *std::find_if(runs.signals.begin(), runs.signals.end(),
                         [&](const auto& signal) { return signal.name == name; });
  }

  const test::TemporaryFolder temporary_;
};

TEST_F(ReplayedVirtualRun, GivesALiveControllerItsRecordedOutputsToTheLastBit) {
  const auto recorded = made("recorded", {});
  const auto again = made("again", replayed("srmd", "machine", recorded));
  const auto found = compared(recorded, again, {"xpc.*", "daq.*", "opf.*", "srmd.*"});

  EXPECT_GT(found.signals.size(), 100U);
  EXPECT_EQ(found.broken(), 0U) << found.signals[0].name;
}

// Rows as often as the solver steps: four in a millisecond.
TEST_F(ReplayedVirtualRun, NeedsNeitherMachineNorSolver) {
  const Overrides rows{{"node.recorder.period_s", "0.00025"}, {"node.recorder.phase_s", "0.0002"}};
  const auto recorded = made("recorded", rows);
  Overrides changes = replayed("srmd", "machine", recorded);
  for (const auto& change : replayed("opf", "solver", recorded)) changes.push_back(change);
  changes.insert(changes.end(), rows.begin(), rows.end());
  const auto again = made("again", changes);
  const auto found = compared(recorded, again, {"xpc.*", "daq.*"});

  EXPECT_EQ(found.broken(), 0U) << found.signals[0].name;
}

constexpr int kTicksBeforeTheEnd = 2400;  // then the command goes to zero

/// Last values of a signal before each tick of the controller, by the number of the tick.
std::map<int, double> by_tick(const recording::Reader& run, const std::string& signal) {
  std::map<int, double> values;
  const auto tick = run.signal("monitor.xpc.host.step"), value = run.signal(signal);
  for (std::size_t row = 0; row < run.rows(); ++row)
    if (tick[row] >= 1) values[static_cast<int>(std::lround(tick[row]))] = value[row];
  return values;
}

// As in real time on a busy host: each of the three nodes is late now and then, by less than a tick
// or by several.
TEST_F(ReplayedVirtualRun, GivesALateControllerItsRecordedOutputsInEachTick) {
  const Overrides rows{{"node.recorder.period_s", "0.00025"}, {"node.recorder.phase_s", "0.0002"}};
  const auto recorded = made("recorded", rows);
  Overrides changes = replayed("srmd", "machine", recorded);
  for (const auto& change : replayed("opf", "solver", recorded)) changes.push_back(change);
  changes.insert(changes.end(), rows.begin(), rows.end());
  const auto again = made("again", changes, [](const std::string& node, Duration due) {
    const auto ms = due / std::chrono::milliseconds{1};
    if (node == "xpc" && ms % 97 == 0) return Duration{std::chrono::microseconds{5'300}};
    if (node == "opf" && ms % 41 == 0) return Duration{std::chrono::microseconds{2'600}};
    if (node == "srmd" && ms % 67 == 0) return Duration{std::chrono::microseconds{700}};
    return Duration{0};
  });

  const recording::Reader a{recorded}, b{again};
  std::size_t ticks = 0, different = 0;
  for (const auto& signal : a.names()) {
    const bool is_output = signal.starts_with("xpc.") || signal.starts_with("daq.");
    if (!is_output || signal.ends_with("time.fbk")) continue;  // the clock of the host
    const auto before = by_tick(a, signal);
    for (const auto& [tick, value] : by_tick(b, signal)) {
      if (tick > kTicksBeforeTheEnd || !before.contains(tick)) continue;
      ++ticks;
      different += before.at(tick) == value ? 0 : 1;
    }
  }
  EXPECT_GT(ticks, 10'000U);
  EXPECT_EQ(different, 0U);
}

TEST_F(ReplayedVirtualRun, ShowsAFlippedBitAndADroppedWord) {
  const auto recorded = made("recorded", {});
  Overrides changes = replayed("srmd", "machine", recorded);
  changes.emplace_back("node.srmd.fault",
                       "[{kind = 'flip', signal = 'srmd.long.displ.fbk', bit = 31, at_s = 1.5, "
                       "for_s = 0.001}, {kind = 'drop', signal = 'srmd.lat.force.fbk', at_s = 2, "
                       "for_s = 0.001}]");
  const auto again = made("again", changes);
  const auto found = compared(recorded, again, {"srmd.*"});

  EXPECT_EQ(found.broken(), 2U);
  EXPECT_EQ(signal_of(found, "srmd.long.displ.fbk").broken_samples, 1U);
  EXPECT_NEAR(*signal_of(found, "srmd.long.displ.fbk").broken_at, 1.5008, 1e-9);
  EXPECT_EQ(signal_of(found, "srmd.lat.force.fbk").broken_samples, 1U);
  EXPECT_NEAR(*signal_of(found, "srmd.lat.force.fbk").broken_at, 2.0008, 1e-9);
}

}  // namespace
}  // namespace rths::session
