// SPDX-License-Identifier: Apache-2.0
#include "conclude.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/cases/case.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/experiment/improvement.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/companions.hpp>
#include <rths/verdict/diagnose.hpp>

#include "mismatch.hpp"
#include "steps.hpp"

namespace rths::session {
namespace {

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
    return experiment_.held_out &&
           std::none_of(experiment_.nodes.begin(), experiment_.nodes.end(),
                        [](const auto& plan) { return plan.adapter == "external"; });
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
      result_.verdict =
          (result_.broken.empty() ? "" : "of a test that is not conclusive: ") + verdict.sentence;
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

}  // namespace

void compress(const std::filesystem::path& recording, const Progress& progress) {
  try {
    if (std::filesystem::exists(recording)) recording::compress(recording);
  } catch (const Error& error) {
    note(progress, error.what());
  }
}

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

}  // namespace rths::session
