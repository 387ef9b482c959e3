// SPDX-License-Identifier: Apache-2.0
#include <rths/session/run.hpp>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/cases/case.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/check.hpp>
#include <rths/experiment/improvement.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/companions.hpp>
#include <rths/session/folder.hpp>

#include "mismatch.hpp"
#include "steps.hpp"

namespace rths::session {
namespace {

using experiment::Experiment;

/// An uncompressed recording is complete, so a failure is only noted.
void compress(const std::filesystem::path& recording, const Progress& progress) {
  try {
    if (std::filesystem::exists(recording)) recording::compress(recording);
  } catch (const Error& error) {
    note(progress, error.what());
  }
}

/// What follows a completed test whose specimen responds.
class RunConclusion {
 public:
  RunConclusion(const RunSettings& settings, const Experiment& experiment, const Progress& progress,
                RunResult& result)
      : settings_{settings}, experiment_{experiment}, progress_{progress}, result_{result} {}

  void all() {
    const bool diagnoses = has_held_out() && settings_.diagnoses;
    NumberedSteps steps{progress_, 3 + (has_held_out() ? 1 : 0) + (diagnoses ? 1 : 0)};
    steps.begin("the test without compensation");
    const auto uncompensated = at(report::kUncompensatedFile),
               numerical = at(report::kNumericalFile);
    make("test without compensation", uncompensated, [&] {
      run_uncompensated(experiment_, at(report::kRunFile), uncompensated, settings_.version);
    });
    steps.begin("the numerical result");
    make("numerical result", numerical,
         [&] { run_numerical(experiment_, numerical, settings_.version); });
    stop_if_interrupted();
    bool is_proved = false;
    if (has_held_out()) {
      steps.begin("the test under the second earthquake");
      const auto held_out = at(diagnosis::kHeldOutFile);
      is_proved = make("test under the second earthquake", held_out,
                       [&] { run_held_out(experiment_, held_out, settings_.version); });
    }
    if (diagnoses && !is_proved) {
      result_.no_diagnosis = "it needs the test under the second earthquake";
    } else if (diagnoses) {
      steps.begin("the diagnosis");
      diagnose();
      compress(at(report::kImprovedFile), progress_);
    }
    steps.begin("the report");
    result_.broken = report::judge_run(result_.folder);
    result_.report = report::make_report(result_.folder, result_.broken);
  }

 private:
  [[nodiscard]] std::filesystem::path at(const char* file) const { return result_.folder / file; }

  [[nodiscard]] bool has_held_out() const {
    return experiment_.held_out && !experiment_.has_user_program();
  }

  // The run's own report does not need its companions.
  template <class Make>
  bool make(const char* what, const std::filesystem::path& file, Make make_it) {
    try {
      make_it();
      compress(file, progress_);
      return true;
    } catch (const Error& error) {
      stop_if_interrupted();
      result_.not_made.push_back(fmt::format("no {}: {}", what, error.what()));
      return false;
    }
  }

  // The recordings are complete, so a failed diagnosis does not stop the report.
  void diagnose() {
    try {
      const auto verdict = verdict_of_run();
      result_.diagnosis = report::write_diagnosis(verdict, result_.folder);
      if (result_.diagnosis->fragment) run_improved(*result_.diagnosis->fragment);
      result_.verdict = (result_.broken.empty() ? "" : "of a test that is not conclusive: ") +
                        report::answers_text(verdict);
    } catch (const Error& error) {
      result_.diagnosis.reset();
      result_.no_diagnosis = error.what();
    }
  }

  [[nodiscard]] diagnosis::Verdict verdict_of_run() const {
    const auto recording = at(report::kRunFile);
    auto verdict = diagnosis::diagnose(diagnosis::load_case(recording));
    verdict.synthetic =
        report::is_of_models(recording::Reader{recording}).value_or(verdict.synthetic);
    for (const auto& condition : result_.broken)
      verdict.limits.push_back("the test is not conclusive: " + condition.text());
    // In virtual time the same experiment gives the same bytes.
    if (settings_.clock == launch::ClockKind::Virtual)
      verdict.seconds = std::numeric_limits<double>::quiet_NaN();
    add_mismatch_budget(recording, settings_.experiment, settings_.changes, verdict);
    return verdict;
  }

  // The diagnosis is written, so a failure is only noted.
  void run_improved(const std::filesystem::path& fragment) const {
    try {
      const auto changes =
          experiment::improved_by({fragment}, settings_.experiment, settings_.changes);
      const auto improved = app::load_experiment(settings_.experiment, changes);
      if (improved.reference) return;  // it does not depend on the model
      run_numerical(improved, at(report::kImprovedFile), settings_.version);
    } catch (const Error& error) {
      note(progress_, std::string{"no improved numerical result: "} + error.what());
    }
  }

  const RunSettings& settings_;
  const Experiment& experiment_;
  const Progress& progress_;
  RunResult& result_;
};

/// Judges the recording of a completed test, computes its companions and its diagnosis, and
/// reports. Of a test with commanded displacements there is no response to judge.
/// @throws Error if the recording is gone, or as report::make_report
void conclude(const RunSettings& settings, const Experiment& experiment, const Progress& progress,
              RunResult& result) {
  const auto recording = result.folder / report::kRunFile;
  if (!std::filesystem::exists(recording))
    throw Error{recording.string() + ": was removed during the run"};
  compress(recording, progress);
  if (experiment.history) return;
  result.broken = report::judge(recording::Reader{recording});
  RunConclusion{settings, experiment, progress, result}.all();
}

/// Reports on a test that the safety layer or a fault of the ring has ended.
void report_end(RunResult& result) {
  try {
    auto broken = report::judge(recording::Reader{result.folder / report::kRunFile});
    const auto trip = std::find_if(broken.begin(), broken.end(), [](const auto& condition) {
      return condition.condition == "safety";
    });
    // The limit that trips is often that of the command, which follows from a wrong feedback.
    if (trip != broken.end())
      std::copy_if(broken.begin(), broken.end(), std::back_inserter(result.broken),
                   [&](const auto& condition) { return condition.time < trip->time; });
    if (trip != broken.end() || result.outcome.has_ring_faults)
      result.report = report::make_report(result.folder, std::move(broken));
  } catch (const Error& error) {
    result.no_report = error.what();
  }
}

// The run would replace its own input.
void refuse_improvements_in(const std::filesystem::path& folder, const RunSettings& settings) {
  const auto replaced = std::filesystem::weakly_canonical(folder / report::kFragmentFile);
  for (const auto& file : experiment::improvements_of(settings.experiment, settings.changes))
    if (std::filesystem::weakly_canonical(file) == replaced)
      throw Error{file.string() +
                  ": this run replaces it, expected another folder for the results (--out)"};
}

RunFolder folder_for(const RunSettings& settings, const std::string& name) {
  if (settings.out.empty()) return RunFolder{std::filesystem::path{"out"} / name};
  refuse_improvements_in(settings.out, settings);
  return RunFolder{settings.out, settings.replaces};
}

void check_host(const RunSettings& settings, const Experiment& experiment) {
  if (settings.host.empty()) return;
  std::vector<std::string> known;
  for (const auto& host : experiment.network.hosts) known.push_back(host.name);
  if (contains(known, settings.host)) return;
  throw Error{fmt::format("{}: has no host '{}', {}", settings.experiment.string(), settings.host,
                          known.empty()
                              ? "expected tables [host.…]"
                              : fmt::format("expected one of {}", fmt::join(known, ", ")))};
}

/// One test in its folder.
class Task {
 public:
  Task(const RunSettings& settings, const Progress& progress)
      : settings_{with_improvements(settings)},
        progress_{progress},
        experiment_{app::load_experiment(settings_.experiment, settings_.changes)} {}

  RunResult all() {
    check();
    if (progress_.checked) progress_.checked();
    RunFolder folder = folder_for(settings_, experiment_.name);
    // In wall time, the launcher itself brings the nodes to rest.
    std::optional<Interruptible> interruptible;
    if (settings_.clock == launch::ClockKind::Virtual) interruptible.emplace();
    run_in(folder);
    if (folder.has_begun()) describe(folder.path());
    if (progress_.recorded) progress_.recorded(result_);
    if (!result_.outcome.completed) {
      if (has_response()) report_end(result_);
      return std::move(result_);
    }
    if (!interruptible) interruptible.emplace();
    if (!has_response())
      for (const auto& line : result_.outcome.foreign_stores) note(progress_, line);
    if (is_recorded_here()) conclude(settings_, experiment_, progress_, result_);
    return std::move(result_);
  }

 private:
  // Now: when the run has begun, the link `latest` leads to another folder.
  static RunSettings with_improvements(RunSettings settings) {
    settings.changes = experiment::improved_by(settings.improvements, settings.experiment,
                                               std::move(settings.changes));
    return settings;
  }

  void check() const {
    static_cast<void>(report::read_bounds(experiment_.conclusive));
    check_host(settings_, experiment_);
    for (const auto& remark : remarks_on(experiment_)) note(progress_, remark);
    if (const auto machine = experiment_.unguarded_machine())
      note(progress_,
           fmt::format("node {} has no safety layer: rths does not guard its commands", *machine));
  }

  void run_in(RunFolder& folder) {
    launch::RunOptions options;
    options.clock = settings_.clock;
    options.recording = folder.path() / report::kRunFile;
    options.ring = settings_.ring.empty() ? experiment_.name : settings_.ring;
    options.host = settings_.host;
    options.interface = settings_.interface;
    options.report = [this](const std::string& line) { note(progress_, line); };
    options.overrides = settings_.changes;
    options.version = settings_.version;
    options.progress = progress_.run;
    options.started = [&] { folder.begin(); };
    result_.outcome = launch::run(experiment_, options);
    const auto late = reason_to_repeat(options.recording);
    if (late.empty()) return;
    note(progress_,
         fmt::format("the host could not keep real time ({}): repeating the test in virtual time",
                     late));
    settings_.clock = launch::ClockKind::Virtual;
    repeat_in_virtual_time(std::move(options));
  }

  // How late the host was, if that may be why the test has no result: in virtual time it has one.
  [[nodiscard]] std::string reason_to_repeat(const std::filesystem::path& recording) const {
    const auto& outcome = result_.outcome;
    const bool is_possible = settings_.repeats_late && experiment_.network.hosts.empty() &&
                             !experiment_.has_user_program() && !experiment_.history;
    if (!is_possible || outcome.interrupted || outcome.stopped_early) return "";
    try {
      const recording::Reader run{recording};
      return outcome.completed && report::judge(run).empty() ? "" : report::late_host_in(run);
    } catch (const Error&) {  // the run's own trouble is reported
      return "";
    }
  }

  // The attempt in real time stays beside the repetition.
  void repeat_in_virtual_time(launch::RunOptions options) {
    const auto attempt = options.recording.parent_path() / report::kRealTimeFile;
    std::filesystem::rename(options.recording, attempt);
    compress(attempt, progress_);
    options.clock = launch::ClockKind::Virtual;
    options.started = nullptr;
    const Interruptible interruptible;
    result_.outcome = launch::run(experiment_, options);
  }

  [[nodiscard]] bool has_recorder() const {
    return std::any_of(experiment_.nodes.begin(), experiment_.nodes.end(),
                       [](const auto& plan) { return plan.adapter == "recorder"; });
  }
  [[nodiscard]] bool is_recorded_here() const {
    return has_recorder() &&
           (settings_.host.empty() || settings_.host == experiment_.leading_host());
  }
  // Commanded displacements have none to judge.
  [[nodiscard]] bool has_response() const {
    return !result_.folder.empty() && is_recorded_here() && !experiment_.history;
  }

  void describe(const std::filesystem::path& folder) {
    result_.folder = folder;
    const auto recording = folder / report::kRunFile;
    if (!has_recorder())
      result_.no_recording = "none: the experiment has no recorder";
    else if (!is_recorded_here())
      result_.no_recording = fmt::format("on host '{}'", experiment_.leading_host());
    else if (std::filesystem::exists(recording))
      result_.recording = recording;
    else
      result_.no_recording = "none: the file is missing";
    if (result_.outcome.completed || !has_response()) return;
    try {
      result_.late = report::lateness_before_trip(recording::Reader{recording});
    } catch (const Error&) {  // NOLINT(bugprone-empty-catch): the test's own end is reported
    }
  }

  RunSettings settings_;
  const Progress& progress_;
  Experiment experiment_;
  RunResult result_;
};

}  // namespace

bool RunResult::is_conclusive() const {
  return outcome.completed && not_made.empty() &&
         (report ? report->conclusive : outcome.foreign_stores.empty());
}

std::string RunResult::ending() const {
  if (outcome.completed) return "completed";
  return (late.empty() ? "" : late + ", then ") +
         (outcome.interrupted ? "interrupted" : outcome.trouble);
}

RunResult run(const RunSettings& settings, const Progress& progress) {
  return Task{settings, progress}.all();
}

report::ReportOutcome report(const std::filesystem::path& folder,
                             const std::filesystem::path& beside) {
  if (!std::filesystem::is_directory(folder))
    throw Error{folder.string() + ": is no folder, expected that of a run"};
  const FolderLock lock{folder};
  return report::make_report(folder, report::judge_run(folder), beside);
}

void check_setup(const Experiment& experiment) {
  static_cast<void>(report::read_bounds(experiment.conclusive));
  launch::check_assembly(experiment);
}

std::vector<std::string> remarks_on(const Experiment& experiment) {
  auto remarks = experiment.remarks;
  for (auto& remark : experiment::check_plausible(experiment)) remarks.push_back(std::move(remark));
  for (auto& remark : remarks) remark = experiment.file.string() + ": " + remark;
  return remarks;
}

}  // namespace rths::session
