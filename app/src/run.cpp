// SPDX-License-Identifier: Apache-2.0
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/cases/case.hpp>
#include <rths/core/contains.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>
#include <rths/experiment/check.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/judgement.hpp>
#include <rths/report/report.hpp>
#include <rths/session/companions.hpp>
#include <rths/verdict/diagnose.hpp>

#include "commands.hpp"
#include "improvements.hpp"
#include "mismatch.hpp"
#include "run_folder.hpp"
#include "steps.hpp"

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
  write_message(fmt::format("\r[{:=<{}}{: <{}}] {:6.2f} / {:.2f} s", "", filled, "",
                            kBarWidth - filled, fraction * progress.duration, progress.duration));
}

void clear_progress() { write_message(fmt::format("\r{: <70}\r", "")); }

// The run would replace its own input.
void refuse_improvements_in(const std::filesystem::path& folder, const RunArguments& arguments) {
  const auto replaced = std::filesystem::weakly_canonical(folder / report::kFragmentFile);
  for (const auto& file : improvements_of(arguments.experiment, arguments.changes))
    if (std::filesystem::weakly_canonical(file) == replaced)
      throw Error{file.string() +
                  ": this run replaces it, expected another folder for the results (--out)"};
}

RunFolder folder_for(const RunArguments& arguments, const std::string& name) {
  if (arguments.out.empty()) return RunFolder{std::filesystem::path{"out"} / name};
  refuse_improvements_in(arguments.out, arguments);
  return RunFolder{arguments.out, arguments.force};
}

bool has_adapter(const experiment::Experiment& experiment, const char* adapter) {
  return std::any_of(experiment.nodes.begin(), experiment.nodes.end(),
                     [&](const auto& plan) { return plan.adapter == adapter; });
}

void check_host(const RunArguments& arguments, const experiment::Experiment& experiment) {
  if (arguments.host.empty()) return;
  std::vector<std::string> known;
  for (const auto& host : experiment.network.hosts) known.push_back(host.name);
  if (contains(known, arguments.host)) return;
  throw Error{fmt::format("{}: has no host '{}', {}", arguments.experiment, arguments.host,
                          known.empty()
                              ? "expected tables [host.…]"
                              : fmt::format("expected one of {}", fmt::join(known, ", ")))};
}

// The diagnosis is written, so a failure is printed only.
void run_improved(const RunArguments& arguments, const std::filesystem::path& fragment,
                  const std::filesystem::path& folder) {
  try {
    const auto changes = improved_by({fragment}, arguments.experiment, arguments.changes);
    const auto experiment = load_experiment(arguments.experiment, changes);
    if (experiment.reference) return;  // it does not depend on the model
    session::run_numerical(experiment, folder / report::kImprovedFile, version());
  } catch (const Error& error) {
    write_message(fmt::format("rths: no improved numerical result: {}\n", error.what()));
  }
}

// Writes the diagnosis of a run and, if it improves the model, the improved numerical result.
diagnosis::Verdict diagnose_run(const RunArguments& arguments, const std::filesystem::path& folder,
                                const std::vector<report::Broken>& broken) {
  diagnosis::Verdict verdict = diagnosis::diagnose(diagnosis::load_case(folder / report::kRunFile));
  verdict.synthetic = report::is_of_models(recording::Reader{folder / report::kRunFile})
                          .value_or(verdict.synthetic);
  for (const auto& condition : broken)
    verdict.limits.push_back("the test is not conclusive: " + condition.text());
  // In virtual time the same experiment gives the same bytes.
  if (arguments.virtual_time) verdict.seconds = std::numeric_limits<double>::quiet_NaN();
  add_mismatch_budget(folder / report::kRunFile, arguments.experiment, arguments.changes, folder,
                      verdict);
  const auto written = report::write_diagnosis(verdict, folder);
  if (written.fragment) run_improved(arguments, *written.fragment, folder);
  return verdict;
}

/// Lines about a diagnosis, or the reason why there is none.
struct Diagnosed {
  std::string text, trouble;
};

// The recordings are complete, so a failed diagnosis does not stop the report.
Diagnosed diagnose(const RunArguments& arguments, const std::filesystem::path& folder,
                   const std::vector<report::Broken>& broken) {
  try {
    const auto verdict = diagnose_run(arguments, folder, broken);
    Diagnosed diagnosed;
    diagnosed.text =
        fmt::format("diagnosis {}\n{}{}\n", (folder / report::kDiagnosisPage).string(),
                    broken.empty() ? "" : "of a test that is not conclusive: ", verdict.sentence);
    for (const auto& file : {folder / report::kImprovedFolder / report::kImprovedExperiment,
                             folder / report::kFragmentFile})
      if (std::filesystem::exists(file))
        diagnosed.text += fmt::format("improved  {}\n", file.string());
    return diagnosed;
  } catch (const Error& error) {
    return {"", error.what()};
  }
}

int print(const report::ReportOutcome& written) {
  fmt::print("report    {}\nnumbers   {}\n{}", written.page.string(), written.numbers.string(),
             written.summary);
  return written.conclusive ? kOk : kConditionNotMet;
}

// An uncompressed recording is complete, so a failure is printed only.
void compress(const std::filesystem::path& file) {
  try {
    if (std::filesystem::exists(file)) recording::compress(file);
  } catch (const Error& error) {
    write_message(fmt::format("rths: {}\n", error.what()));
  }
}

/// Companions of a run that failed, one line each. The run's own report does not need them.
class Companions {
 public:
  template <class Make>
  bool make(const char* what, const std::filesystem::path& file, Make make) {
    try {
      make();
      compress(file);
      return true;
    } catch (const Error& error) {
      stop_if_interrupted();
      trouble_ += fmt::format("rths: no {}: {}\n", what, error.what());
      return false;
    }
  }
  /// Prints the failures. @returns whether there are none
  [[nodiscard]] bool are_complete() const {
    write_message(trouble_);
    return trouble_.empty();
  }

 private:
  std::string trouble_;
};

// Computes the companions of a completed run, its diagnosis and its report.
int conclude(const RunArguments& arguments, const experiment::Experiment& experiment,
             const std::filesystem::path& folder, std::vector<report::Broken> broken) {
  const bool has_held_out = experiment.held_out.has_value() && !has_adapter(experiment, "external");
  const bool diagnoses = has_held_out && arguments.diagnoses;
  std::optional<Steps> steps{std::in_place, 3 + (has_held_out ? 1 : 0) + (diagnoses ? 1 : 0)};
  Companions companions;
  steps->begin("the test without compensation");
  const auto uncompensated = folder / report::kUncompensatedFile;
  companions.make("test without compensation", uncompensated, [&] {
    session::run_uncompensated(experiment, folder / report::kRunFile, uncompensated, version());
  });
  steps->begin("the numerical result");
  const auto numerical = folder / report::kNumericalFile;
  companions.make("numerical result", numerical,
                  [&] { session::run_numerical(experiment, numerical, version()); });
  stop_if_interrupted();
  bool is_proved = has_held_out;
  if (has_held_out) {
    steps->begin("the test under the second earthquake");
    const auto held_out = folder / diagnosis::kHeldOutFile;
    is_proved = companions.make("test under the second earthquake", held_out,
                                [&] { session::run_held_out(experiment, held_out, version()); });
  }
  Diagnosed diagnosed;
  if (diagnoses && !is_proved) {
    diagnosed.trouble = "it needs the test under the second earthquake";
  } else if (diagnoses) {
    steps->begin("the diagnosis");
    diagnosed = diagnose(arguments, folder, broken);
    compress(folder / report::kImprovedFile);
  }
  steps->begin("the report");
  broken = report::judge_run(folder);
  const auto written = report::make_report(folder, broken);
  steps.reset();  // removes its line before the results are printed
  fmt::print("{}", diagnosed.text);
  if (!diagnosed.trouble.empty())
    write_message(fmt::format("rths: no diagnosis: {}\n", diagnosed.trouble));
  const int conclusive = print(written);
  return companions.are_complete() ? conclusive : int{kConditionNotMet};
}

launch::RunOptions options_for(const RunArguments& arguments, const std::string& name,
                               const std::filesystem::path& folder) {
  launch::RunOptions options;
  options.clock = arguments.virtual_time ? launch::ClockKind::Virtual : launch::ClockKind::Wall;
  options.recording = folder / report::kRunFile;
  options.ring = arguments.ring.empty() ? name : arguments.ring;
  options.host = arguments.host;
  options.interface = arguments.interface;
  options.report = [](const std::string& line) { write_message(fmt::format("rths: {}\n", line)); };
  options.overrides = arguments.changes;
  options.version = version();
  if (isatty(STDERR_FILENO) == 1) options.progress = show_progress;
  return options;
}

/// Where the recording of a run is.
enum class Recorded { Here, OnAnotherHost, Nowhere };

Recorded recorded(const RunArguments& arguments, const experiment::Experiment& experiment) {
  if (!has_adapter(experiment, "recorder")) return Recorded::Nowhere;
  return arguments.host.empty() || arguments.host == experiment.leading_host()
             ? Recorded::Here
             : Recorded::OnAnotherHost;
}

std::string text_of(Recorded recorded, const std::filesystem::path& recording,
                    const experiment::Experiment& experiment) {
  if (recorded == Recorded::Here)
    return std::filesystem::exists(recording) ? recording.string() : "none: the file is missing";
  if (recorded == Recorded::OnAnotherHost)
    return fmt::format("on host '{}'", experiment.leading_host());
  return "none: the experiment has no recorder";
}

// Judges the recording of a completed run and reports on it.
int judge_and_report(const RunArguments& arguments, const experiment::Experiment& experiment,
                     const std::filesystem::path& folder) {
  const auto recording = folder / report::kRunFile;
  if (!std::filesystem::exists(recording))
    throw Error{recording.string() + ": was removed during the run"};
  compress(recording);
  if (experiment.history) return kOk;  // commanded displacements: no response to judge
  return conclude(arguments, experiment, folder, report::judge(recording::Reader{recording}));
}

// A run that the safety layer or a fault of the ring has ended has a report, too, which says so.
void report_end(const std::filesystem::path& folder, bool has_ring_faults) {
  try {
    const auto broken = report::judge(recording::Reader{folder / report::kRunFile});
    const auto trip = std::find_if(broken.begin(), broken.end(), [](const auto& condition) {
      return condition.condition == "safety";
    });
    // The limit that trips is often that of the command, which follows from a wrong feedback.
    if (trip != broken.end())
      for (const auto& condition : broken)
        if (condition.time < trip->time)
          write_message(fmt::format("rths: before it: {}\n", condition.text()));
    if (trip != broken.end() || has_ring_faults)
      fmt::print("report    {}\n", report::make_report(folder, broken).page.string());
  } catch (const Error& error) {
    write_message(fmt::format("rths: no report: {}\n", error.what()));
  }
}

// The cause of a trip comes before it; empty if nothing was late.
std::string lateness_before_trip(const std::filesystem::path& recording) {
  try {
    const auto late = report::lateness_before_trip(recording::Reader{recording});
    return late.empty() ? "" : late + ", then ";
  } catch (const Error&) {
    return "";
  }
}

// @param folder  of the recorded response; empty: there is none   @returns the exit code
int end_early(const launch::RunOutcome& outcome, const std::filesystem::path& folder) {
  const std::string late = folder.empty() ? "" : lateness_before_trip(folder / report::kRunFile);
  write_message(fmt::format("rths: the run ended early: {}{}\n", late,
                            outcome.interrupted ? "interrupted" : outcome.trouble));
  if (!folder.empty()) report_end(folder, outcome.has_ring_faults);
  return outcome.interrupted ? kConditionNotMet : kFailure;
}

// How late the host was, if that may be why the test has no result: in virtual time it has one.
std::string reason_to_repeat(const RunArguments& arguments,
                             const experiment::Experiment& experiment,
                             const launch::RunOutcome& outcome,
                             const std::filesystem::path& recording) {
  const bool is_possible = arguments.repeats_late && experiment.network.hosts.empty() &&
                           !experiment.has_user_program() && !experiment.history;
  if (!is_possible || outcome.interrupted || outcome.stopped_early) return "";
  try {
    const recording::Reader run{recording};
    return outcome.completed && report::judge(run).empty() ? "" : report::late_host_in(run);
  } catch (const Error&) {  // the run's own trouble is reported
    return "";
  }
}

// The attempt in real time stays beside the repetition.
launch::RunOutcome repeat_in_virtual_time(const experiment::Experiment& experiment,
                                          launch::RunOptions options) {
  const auto attempt = options.recording.parent_path() / report::kRealTimeFile;
  std::filesystem::rename(options.recording, attempt);
  compress(attempt);
  options.clock = launch::ClockKind::Virtual;
  options.started = nullptr;
  const Interruptible interruptible;
  return launch::run(experiment, options);
}

}  // namespace

int run(const RunArguments& given) {
  RunArguments arguments = given;
  // Now: when the run has begun, the link `latest` leads to another folder.
  arguments.changes = improved_by(given.improvements, given.experiment, given.changes);
  const experiment::Experiment experiment =
      load_experiment(arguments.experiment, arguments.changes);
  static_cast<void>(report::read_bounds(experiment.conclusive));
  check_host(arguments, experiment);
  check_sizes(experiment);
  if (const auto machine = experiment.unguarded_machine())
    write_message(fmt::format(
        "rths: node {} has no safety layer: rths does not guard its commands\n", *machine));
  RunFolder run_folder = folder_for(arguments, experiment.name);
  launch::RunOptions options = options_for(arguments, experiment.name, run_folder.path());
  options.started = [&] { run_folder.begin(); };
  // In wall time, the launcher itself brings the nodes to rest.
  std::optional<Interruptible> interruptible;
  if (arguments.virtual_time) interruptible.emplace();
  launch::RunOutcome outcome = launch::run(experiment, options);
  if (options.progress) clear_progress();
  const Recorded where = recorded(arguments, experiment);
  if (const auto late = reason_to_repeat(arguments, experiment, outcome, options.recording);
      !late.empty()) {
    write_message(fmt::format(
        "rths: the host could not keep real time ({}): repeating the test in virtual time\n",
        late));
    arguments.virtual_time = true;
    outcome = repeat_in_virtual_time(experiment, options);
    if (options.progress) clear_progress();
  }
  if (run_folder.has_begun())
    fmt::print(
        "recording {}{}\n", text_of(where, options.recording, experiment),
        outcome.rows_missing > 0 ? fmt::format(", {} rows missing", outcome.rows_missing) : "");
  if (!outcome.completed) {
    const bool has_response =
        run_folder.has_begun() && where == Recorded::Here && !experiment.history;
    return end_early(outcome, has_response ? run_folder.path() : "");
  }
  if (!interruptible) interruptible.emplace();
  if (where == Recorded::Here && !experiment.history)
    return judge_and_report(arguments, experiment, run_folder.path());
  for (const auto& line : outcome.foreign_stores) write_message("rths: " + line + "\n");
  if (where == Recorded::Here) judge_and_report(arguments, experiment, run_folder.path());
  return outcome.foreign_stores.empty() ? kOk : kConditionNotMet;
}

int node(const NodeArguments& arguments) {
  const experiment::Experiment experiment =
      load_experiment(arguments.experiment, arguments.changes);
  return launch::run_node(experiment, arguments.node, arguments.ring, arguments.recording,
                          version());
}

int report(const std::string& folder, const std::string& beside) {
  if (!std::filesystem::is_directory(folder))
    throw Error{folder + ": is no folder, expected that of a run"};
  const FolderLock lock{folder};
  return print(report::make_report(folder, report::judge_run(folder), beside));
}

void check_sizes(const experiment::Experiment& experiment) {
  for (const auto& remarks : {experiment.remarks, experiment::check_plausible(experiment)})
    for (const auto& remark : remarks)
      write_message(fmt::format("rths: {}: {}\n", experiment.file.string(), remark));
}

std::string version() { return RTHS_VERSION; }

}  // namespace rths::app
