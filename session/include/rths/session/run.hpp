// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <rths/launch/run.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/judgement.hpp>
#include <rths/report/report.hpp>
#include <rths/session/progress.hpp>

namespace rths::session {

/// What to run, and where.
struct RunSettings {
  std::filesystem::path experiment;
  experiment::Overrides changes;                    ///< to the experiment
  std::vector<std::filesystem::path> improvements;  ///< improved.toml files, added to the model
  launch::ClockKind clock = launch::ClockKind::Wall;
  bool repeats_late = false;  ///< in virtual time, a test whose host could not keep real time
  std::filesystem::path out;  ///< folder; empty: a new one in out/<name of the experiment>
  bool replaces = false;      ///< the results of an earlier run in `out`
  std::string ring;           ///< empty: the experiment's name
  std::string host;           ///< this host, of an experiment on several; empty: all nodes run here
  std::string interface;      ///< of the network to the other hosts; empty: the experiment's
  bool diagnoses = true;      ///< if there is a [held_out] motion
  std::string version;        ///< of the program, for the recordings
};

/// A test, its companions and what they show.
struct RunResult {
  std::filesystem::path folder;  ///< of all results; empty: the test has not begun
  launch::RunOutcome outcome;
  std::filesystem::path recording;     ///< empty: there is none on this host
  std::string no_recording;            ///< where it is, or why there is none
  std::string late;                    ///< what was late before a safety trip; empty: nothing was
  std::vector<report::Broken> broken;  ///< conditions of a conclusive test; of a test that ended
                                       ///< early, those before its end
  std::vector<std::string> not_made;   ///< companions that failed, and why
  std::optional<report::DiagnosisFiles> diagnosis;
  std::string verdict;       ///< headline and answers of the diagnosis
  std::string no_diagnosis;  ///< why a diagnosis that was due failed
  std::optional<report::ReportOutcome> report;
  std::string no_report;  ///< why the report of a test that ended early failed

  /// The test has a recording, and if it responds, all companions; no condition is broken, and no
  /// other process has stored words.
  [[nodiscard]] bool is_conclusive() const;
  /// How the test ended.
  [[nodiscard]] std::string ending() const;
};

/// One JSON document.
[[nodiscard]] std::string json_of(const RunResult& result);

/// Runs an experiment in a folder that is locked meanwhile. A test that is completed and responds
/// is then judged, computed without compensation, numerically and under the second earthquake,
/// diagnosed and reported; the improved model gives another numerical result.
/// In virtual time and after the test, a signal that asks the process to end stops it.
/// @throws Error if the test cannot begin, its recording is removed, or the report cannot be made;
///         Interrupted   @setup
RunResult run(const RunSettings& settings, const Progress& progress = {});

/// Judges a recorded run again and rewrites its report.
/// @param beside  the folder of another run, to show its response, too; or empty
/// @throws Error as report::make_report, or if another process writes there   @setup
report::ReportOutcome report(const std::filesystem::path& folder,
                             const std::filesystem::path& beside = {});

/// Checks bounds, map and ports of an experiment, as a run does before it begins.
/// @throws Error that names the first fault   @setup
void check_setup(const experiment::Experiment& experiment);

/// Unusual sizes and keys without an effect, a line each. @throws Error if a size is implausible
[[nodiscard]] std::vector<std::string> remarks_on(const experiment::Experiment& experiment);

}  // namespace rths::session
