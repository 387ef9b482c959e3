// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>

#include <fmt/format.h>

#include <rths/launch/run.hpp>
#include <rths/report/report.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

constexpr int kBarWidth = 40;

// A bar on a terminal; silence anywhere else.
void show_progress(const launch::Progress& progress) {
  const double part = std::min(1.0, std::max(0.0, progress.model_time / progress.duration));
  const int filled = static_cast<int>(part * kBarWidth);
  fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:6.2f} / {:.2f} s", "", filled, "", kBarWidth - filled,
             part * progress.duration, progress.duration);
}

void clear_progress() { fmt::print(stderr, "\r{: <70}\r", ""); }

}  // namespace

int run(const RunArguments& arguments) {
  const launch::Experiment experiment =
      launch::load_experiment(arguments.experiment, arguments.changes);
  const std::filesystem::path folder =
      arguments.out.empty() ? "out/" + experiment.name : arguments.out;
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  launch::RunOptions options;
  options.clock = arguments.virtual_time ? launch::ClockKind::Virtual : launch::ClockKind::Wall;
  options.recording = folder / report::kRunFile;
  options.ring = arguments.ring.empty() ? experiment.name : arguments.ring;
  options.overrides = arguments.changes;
  options.version = version();
  if (on_terminal) options.progress = show_progress;
  const launch::RunOutcome outcome = launch::run(experiment, options);
  if (on_terminal) clear_progress();
  const bool recorded = std::filesystem::exists(options.recording);
  fmt::print("recording {}\n",
             recorded ? options.recording.string() : "none: no recorder took part");
  if (!outcome.completed) {
    fmt::print(stderr, "rths: the run ended early: {}\n",
               outcome.interrupted ? "interrupted" : outcome.trouble);
    return outcome.interrupted ? kConditionNotMet : kFailure;
  }
  if (!recorded) return kOk;
  launch::run_uncompensated(experiment, options.recording, folder / report::kUncompensatedFile,
                            version());
  launch::run_numerical(experiment, folder / report::kNumericalFile);
  const auto written = report::make_report(folder);
  fmt::print("report    {}\nnumbers   {}\n{}", written.page.string(), written.numbers.string(),
             written.summary);
  return kOk;
}

int node(const NodeArguments& arguments) {
  const launch::Experiment experiment =
      launch::load_experiment(arguments.experiment, arguments.changes);
  return launch::run_node(experiment, arguments.node, arguments.ring, arguments.recording,
                          version());
}

int report(const std::string& folder) {
  const auto written = report::make_report(folder);
  fmt::print("report    {}\nnumbers   {}\n{}", written.page.string(), written.numbers.string(),
             written.summary);
  return kOk;
}

std::string version() { return RTHS_VERSION; }

}  // namespace rths::app
