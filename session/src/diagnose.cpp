// SPDX-License-Identifier: Apache-2.0
#include <rths/session/diagnose.hpp>

#include <algorithm>
#include <utility>

#include <rths/cases/against.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/report.hpp>
#include <rths/verdict/diagnose.hpp>

#include "diagnosis_of.hpp"
#include "mismatch.hpp"
#include "steps.hpp"

namespace rths::session {
namespace {

// The case's name without slashes; the name of its folder if that is no file name.
std::string folder_name(const diagnosis::Case& c) {
  std::string name = c.name;
  std::replace(name.begin(), name.end(), '/', '_');
  const bool is_name = !name.empty() && name != "." && name != "..";
  return is_name ? name : std::filesystem::canonical(c.folder).filename().string();
}

bool is_run(const std::filesystem::path& path) {
  std::error_code problem;
  return std::filesystem::is_regular_file(path, problem) && path.extension() != ".toml";
}

// The recording in the folder of a run; otherwise the path itself.
std::filesystem::path case_at(const std::filesystem::path& path) {
  std::error_code problem;
  const bool is_folder_of_run = std::filesystem::exists(path / report::kRunFile, problem) &&
                                !std::filesystem::exists(path / "case.toml", problem);
  return is_folder_of_run ? path / report::kRunFile : path;
}

const std::filesystem::path& without_inputs(const std::filesystem::path& folder,
                                            const std::vector<std::filesystem::path>& inputs) {
  report::refuse_inputs_in(folder, inputs);
  return folder;
}

}  // namespace

VerdictFolder::VerdictFolder(const std::filesystem::path& folder,
                             const std::vector<std::filesystem::path>& inputs)
    : made_{without_inputs(folder, inputs)}, lock_{folder} {
  report::refuse_foreign_files_in(folder);
}

diagnosis::Case case_of(const DiagnoseSettings& settings) {
  auto c = diagnosis::load_case(case_at(settings.source));
  return settings.against.empty() ? c : diagnosis::with_prediction(std::move(c), settings.against);
}

DiagnosisResult diagnose_into(const std::filesystem::path& folder, const diagnosis::Case& c,
                              const DiagnoseSettings& settings, TestState state,
                              const Progress& progress) {
  NumberedSteps steps{progress, 2};
  steps.begin("the diagnosis");
  auto verdict = diagnosis::diagnose(c, {settings.without, settings.seed, progress.fits});
  if (const auto recording = case_at(settings.source); is_run(recording)) {
    verdict.synthetic =
        report::is_of_models(recording::Reader{recording}).value_or(verdict.synthetic);
    if (state == TestState::Running)
      verdict.limits.emplace_back(
          "There is no mismatch budget of the response: the test has not ended.");
    else if (settings.against.empty())
      add_mismatch_budget(recording, verdict);
  }
  steps.begin("its page");
  auto files = report::write_diagnosis(verdict, folder);
  return {std::move(verdict), std::move(files)};
}

DiagnosisResult diagnose(const DiagnoseSettings& settings, const Progress& progress) {
  const Interruptible interruptible;
  const diagnosis::Case c = case_of(settings);
  const auto folder =
      settings.out.empty() ? std::filesystem::path{"out/diagnosis"} / folder_name(c) : settings.out;
  const VerdictFolder locked{folder, c.source.inputs};
  return diagnose_into(folder, c, settings, TestState::Ended, progress);
}

diagnosis::Case checked_case(const std::filesystem::path& file) {
  auto c = diagnosis::load_case(file);
  diagnosis::check_model(c);
  return c;
}

diagnosis::Plan plan(const DiagnoseSettings& settings) {
  const Interruptible interruptible;
  return diagnosis::plan(case_of(settings), {settings.without, settings.seed, {}});
}

}  // namespace rths::session
