// SPDX-License-Identifier: Apache-2.0
#include "mismatch.hpp"

#include <map>
#include <optional>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/cases/case.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>
#include <rths/session/hybrid_test.hpp>

#include "error_bars.hpp"

namespace rths::session {
namespace {

budget::MismatchBudget budget_of(const std::filesystem::path& recording,
                                 const std::filesystem::path& file,
                                 const experiment::Overrides& changes,
                                 const std::string& fragment) {
  const auto experiment = app::load_experiment(file, changes);
  const auto improved = fragment.empty() ? experiment
                                         : experiment::load_experiment(app::builtin_adapters(),
                                                                       file, changes, fragment);
  const auto unseen = recording.parent_path() / diagnosis::kHeldOutFile;
  std::optional<recording::Reader> held_out;
  if (std::filesystem::exists(unseen) && !std::filesystem::equivalent(unseen, recording))
    held_out.emplace(unseen);
  return budget_of_run(experiment, improved, recording::Reader{recording},
                       held_out ? &*held_out : nullptr);
}

// Companions of earlier versions have no mark.
bool is_companion(const std::filesystem::path& recording,
                  const std::map<std::string, std::string>& meta) {
  return meta.contains(launch::kCompanion) || recording.filename() == diagnosis::kHeldOutFile ||
         recording.filename() == report::kUncompensatedFile;
}

// The improved simulation as an experiment, if the transfer system is identified.
void improve_experiment(const std::filesystem::path& file, const experiment::Overrides& changes,
                        diagnosis::Verdict& verdict) {
  if (verdict.conclusion.outcome != diagnosis::Outcome::Missing ||
      !budget::is_tracking_identified(verdict.budget))
    return;
  const Config experiment =
      experiment::changed_experiment(std::filesystem::absolute(file), changes);
  auto& improved = verdict.improvement.source;
  improved.experiment =
      session::improved_experiment(experiment, verdict.improvement.fragment, verdict.budget);
  improved.experiment_folder = experiment.resolve("");
  improved.has_improved_laboratory = true;
}

}  // namespace

std::string change_since(const recording::Reader& run, const std::filesystem::path& experiment) {
  if (!std::filesystem::exists(experiment))
    return fmt::format("{} is missing", experiment.string());
  if (read_file(experiment, kMostTextBytes) != run.config(experiment.filename().string()))
    return fmt::format("{} has changed since the run", experiment.string());
  return "";
}

void add_mismatch_budget(const std::filesystem::path& recording,
                         const std::filesystem::path& experiment,
                         const experiment::Overrides& changes, diagnosis::Verdict& verdict) {
  try {
    add_response_bands(experiment, changes, verdict);
  } catch (const Error& error) {
    verdict.limits.push_back(std::string{"The improved response has no intervals: "} +
                             error.what());
  }
  try {
    diagnosis::add_budget(budget_of(recording, experiment, changes, verdict.improvement.fragment),
                          verdict);
  } catch (const Error& error) {
    verdict.limits.push_back(std::string{"There is no mismatch budget of the response: "} +
                             error.what());
    return;
  }
  try {
    improve_experiment(experiment, changes, verdict);
  } catch (const Error& error) {
    verdict.limits.push_back(std::string{"The improved simulation is no experiment: "} +
                             error.what());
  }
}

void add_mismatch_budget(const std::filesystem::path& recording, diagnosis::Verdict& verdict) {
  const recording::Reader run{recording};
  if (is_companion(recording, run.meta())) {
    verdict.limits.push_back(recording.string() +
                             ": found a companion of a run, expected the run itself for a mismatch "
                             "budget of the response");
    return;
  }
  const std::string path = recording::experiment_path(run);
  if (path.empty()) return;
  if (const auto trouble = change_since(run, path); !trouble.empty()) {
    verdict.limits.push_back(
        fmt::format("There is no mismatch budget of the response: {}.", trouble));
    return;
  }
  add_mismatch_budget(recording, path, recording::overrides_of(run), verdict);
}

}  // namespace rths::session
