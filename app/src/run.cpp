// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/diagnosis/case.hpp>
#include <rths/diagnosis/diagnose.hpp>
#include <rths/launch/run.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

constexpr int kBarWidth = 40;

// Draws a progress bar. The caller checks for a terminal.
void show_progress(const launch::Progress& progress) {
  // Ctrl-S stops the output of a terminal, and writing would stop this process.
  pollfd terminal{STDERR_FILENO, POLLOUT, 0};
  if (poll(&terminal, 1, 0) <= 0) return;
  const double fraction = std::min(1.0, std::max(0.0, progress.model_time / progress.duration));
  const int filled = static_cast<int>(fraction * kBarWidth);
  fmt::print(stderr, "\r[{:=<{}}{: <{}}] {:6.2f} / {:.2f} s", "", filled, "", kBarWidth - filled,
             fraction * progress.duration, progress.duration);
}

void clear_progress() { fmt::print(stderr, "\r{: <70}\r", ""); }

// The files as a TOML list of absolute paths.
std::string listed(const std::vector<std::string>& files) {
  std::string list;
  for (const auto& file : files) {
    std::string text;
    for (const char c : std::filesystem::absolute(file).string())
      text += c == '\\' || c == '"' ? std::string{'\\', c} : std::string{c};
    list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", text);
  }
  return "[" + list + "]";
}

Changes changes_of(const RunArguments& arguments, const std::vector<std::string>& improvements) {
  Changes changes = arguments.changes;
  if (!improvements.empty()) changes.emplace_back("model.improvement", listed(improvements));
  return changes;
}

// Removes the results of an earlier run, which could be taken for this one's.
void remove_results(const std::filesystem::path& folder,
                    const std::vector<std::string>& improvements) {
  for (const auto& file : improvements)
    if (std::filesystem::weakly_canonical(file) ==
        std::filesystem::weakly_canonical(folder / report::kFragmentFile))
      throw Error{file + ": this run replaces it, expected another folder for the results (--out)"};
  for (const char* file :
       {report::kRunFile, report::kUncompensatedFile, report::kNumericalFile, report::kImprovedFile,
        diagnosis::kHeldOutFile, report::kVerdictFile, report::kDiagnosisPage,
        report::kFragmentFile, "report.html", "report.json"})
    std::filesystem::remove(folder / file);
}

// Writes the diagnosis of a run and, if it improves the model, the improved numerical result.
diagnosis::Verdict diagnose_run(const RunArguments& arguments,
                                const std::filesystem::path& folder) {
  diagnosis::Verdict verdict = diagnosis::diagnose(diagnosis::load_case(folder / report::kRunFile));
  verdict.synthetic = true;  // in this version, specimen and machine are models
  // In virtual time the same experiment gives the same bytes.
  if (arguments.virtual_time) verdict.seconds = std::numeric_limits<double>::quiet_NaN();
  const auto written = report::write_diagnosis(verdict, folder);
  if (!written.fragment) return verdict;
  auto improvements = arguments.improvements;
  improvements.push_back(written.fragment->string());
  launch::run_numerical(
      launch::load_experiment(arguments.experiment, changes_of(arguments, improvements)),
      folder / report::kImprovedFile);
  return verdict;
}

// The recordings are complete, so a failed diagnosis is printed and does not stop the report.
void diagnose_and_print(const RunArguments& arguments, const std::filesystem::path& folder) {
  try {
    const auto verdict = diagnose_run(arguments, folder);
    fmt::print("diagnosis {}\n{}\n", (folder / report::kDiagnosisPage).string(), verdict.sentence);
    if (!verdict.fragment.empty())
      fmt::print("improved  {}\n", (folder / report::kFragmentFile).string());
  } catch (const Error& error) {
    fmt::print(stderr, "rths: no diagnosis: {}\n", error.what());
  }
}

int print(const report::ReportOutcome& written) {
  fmt::print("report    {}\nnumbers   {}\n{}", written.page.string(), written.numbers.string(),
             written.summary);
  return kOk;
}

}  // namespace

int run(const RunArguments& arguments) {
  const Changes changes = changes_of(arguments, arguments.improvements);
  const launch::Experiment experiment = launch::load_experiment(arguments.experiment, changes);
  const std::filesystem::path folder =
      arguments.out.empty() ? "out/" + experiment.name : arguments.out;
  const bool on_terminal = isatty(STDERR_FILENO) == 1;
  launch::RunOptions options;
  options.clock = arguments.virtual_time ? launch::ClockKind::Virtual : launch::ClockKind::Wall;
  options.recording = folder / report::kRunFile;
  options.ring = arguments.ring.empty() ? experiment.name : arguments.ring;
  options.overrides = changes;
  options.version = version();
  if (on_terminal) options.progress = show_progress;
  remove_results(folder, arguments.improvements);
  const launch::RunOutcome outcome = launch::run(experiment, options);
  if (on_terminal) clear_progress();
  const bool recorded = std::filesystem::exists(options.recording);
  fmt::print(
      "recording {}{}\n",
      recorded ? options.recording.string() : "none: the experiment has no recorder",
      outcome.rows_missing > 0 ? fmt::format(", {} rows missing", outcome.rows_missing) : "");
  if (!outcome.completed) {
    fmt::print(stderr, "rths: the run ended early: {}\n",
               outcome.interrupted ? "interrupted" : outcome.trouble);
    return outcome.interrupted ? kConditionNotMet : kFailure;
  }
  // The report is about tracking, so it needs a controller.
  const bool is_controlled =
      std::any_of(experiment.nodes.begin(), experiment.nodes.end(),
                  [](const auto& plan) { return plan.adapter == "simulink_like"; });
  if (!recorded || !is_controlled) return kOk;
  launch::run_uncompensated(experiment, options.recording, folder / report::kUncompensatedFile,
                            version());
  launch::run_numerical(experiment, folder / report::kNumericalFile);
  const bool has_held_out =
      launch::run_held_out(experiment, folder / diagnosis::kHeldOutFile, version());
  if (has_held_out && arguments.diagnoses) diagnose_and_print(arguments, folder);
  return print(report::make_report(folder));
}

int node(const NodeArguments& arguments) {
  const launch::Experiment experiment =
      launch::load_experiment(arguments.experiment, arguments.changes);
  return launch::run_node(experiment, arguments.node, arguments.ring, arguments.recording,
                          version());
}

int report(const std::string& folder) { return print(report::make_report(folder)); }

std::string version() { return RTHS_VERSION; }

}  // namespace rths::app
