// SPDX-License-Identifier: Apache-2.0
#include "recorded_times.hpp"

#include <cmath>
#include <map>
#include <string>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>

#include "support/files.hpp"

namespace rths::test {
namespace {

constexpr double kRow = 1e-3;       // [s]
constexpr double kRounding = 2e-6;  // of the recorded times, in single precision [s]

/// What a node reports of its steps, by their number.
struct Steps {
  std::map<long, double> begin;     ///< time of the start [s]
  std::map<long, double> duration;  ///< [s]
};

Steps steps_of(const recording::Reader& run, const std::string& node, const Schedule& schedule) {
  const std::string prefix = "monitor." + node + ".host.";
  const auto count = run.signal(prefix + "step");
  const auto late = run.signal(prefix + "late");
  const auto duration = run.signal(prefix + "duration");
  const auto skipped = run.signal(prefix + "skipped");
  Steps steps;
  for (std::size_t row = 0; row < count.size(); ++row) {
    const long step = std::lround(count[row]);
    if (step < 1) continue;
    const long due = step - 1 + std::lround(skipped[row]);
    steps.begin[step] = to_seconds(schedule.phase + due * schedule.period) + late[row];
    steps.duration[step - 1] = duration[row];  // a step reports the duration of the one before
  }
  return steps;
}

void compare(const recording::Reader& run, const std::string& node, const Schedule& schedule,
             RecordedTimes& times) {
  const Steps steps = steps_of(run, node, schedule);
  const auto count = run.signal("monitor." + node + ".host.step");
  for (std::size_t row = 0; row < count.size(); ++row) {
    const double time = run.time()[row];
    const long step = std::lround(count[row]);
    if (step < 1) continue;
    const auto next = steps.begin.find(step + 1);
    const auto next_duration = steps.duration.find(step + 1);
    const bool too_new = steps.begin.at(step) > time + kRow + kRounding;
    const bool too_old = next != steps.begin.end() && next_duration != steps.duration.end() &&
                         next->second + next_duration->second < time - kRounding;
    ++times.compared;
    times.wrong += too_new || too_old ? 1 : 0;
  }
}

}  // namespace

RecordedTimes recorded_times(const std::filesystem::path& file) {
  const recording::Reader run{file};
  RecordedTimes times;
  for (std::size_t row = 1; row < run.rows(); ++row)
    times.gaps += std::lround((run.time()[row] - run.time()[row - 1]) / kRow) - 1;
  const auto experiment =
      app::load_experiment(source_tree() / "examples" / run.meta().at("experiment"));
  // These two run on schedule only, and every millisecond.
  for (const auto& plan : experiment.nodes)
    if (plan.node == "srmd" || plan.node == "xpc") compare(run, plan.node, plan.schedule, times);
  return times;
}

}  // namespace rths::test
