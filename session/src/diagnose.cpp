// SPDX-License-Identifier: Apache-2.0
#include <rths/session/diagnose.hpp>

#include <algorithm>
#include <utility>

#include <rths/cases/against.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/report.hpp>
#include <rths/session/folder.hpp>
#include <rths/verdict/diagnose.hpp>

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

diagnosis::Case load(const DiagnoseSettings& settings) {
  auto c = diagnosis::load_case(case_at(settings.source));
  return settings.against.empty() ? c : diagnosis::with_prediction(std::move(c), settings.against);
}

}  // namespace

DiagnosisResult diagnose(const DiagnoseSettings& settings, const Progress& progress) {
  const Interruptible interruptible;
  const diagnosis::Case c = load(settings);
  const auto folder =
      settings.out.empty() ? std::filesystem::path{"out/diagnosis"} / folder_name(c) : settings.out;
  report::refuse_inputs_in(folder, c.source.inputs);
  const NewFolder made{folder};
  const FolderLock lock{folder};
  report::refuse_foreign_files_in(folder);
  NumberedSteps steps{progress, 2};
  steps.begin("the diagnosis");
  auto verdict = diagnosis::diagnose(c, {settings.without, settings.seed, progress.fits});
  if (const auto recording = case_at(settings.source); is_run(recording)) {
    verdict.synthetic =
        report::is_of_models(recording::Reader{recording}).value_or(verdict.synthetic);
    if (settings.against.empty()) add_mismatch_budget(recording, verdict);
  }
  steps.begin("its page");
  auto files = report::write_diagnosis(verdict, folder);
  return {std::move(verdict), std::move(files)};
}

diagnosis::Case checked_case(const std::filesystem::path& file) {
  auto c = diagnosis::load_case(file);
  diagnosis::check_model(c);
  return c;
}

diagnosis::Plan plan(const DiagnoseSettings& settings) {
  const Interruptible interruptible;
  return diagnosis::plan(load(settings), {settings.without, settings.seed, {}});
}

}  // namespace rths::session
