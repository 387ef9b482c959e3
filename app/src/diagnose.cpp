// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <rths/cases/against.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>
#include <rths/verdict/diagnose.hpp>

#include "commands.hpp"
#include "mismatch.hpp"
#include "run_folder.hpp"
#include "steps.hpp"

namespace rths::app {
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

diagnosis::Case load(const DiagnoseArguments& arguments) {
  diagnosis::Case c = diagnosis::load_case(case_at(arguments.case_or_recording));
  return arguments.against.empty() ? c
                                   : diagnosis::with_prediction(std::move(c), arguments.against);
}

diagnosis::Progress::Show shown_by(Steps& steps) {
  return [&steps](const diagnosis::Progress::State& state) {
    steps.detail(state.step.empty() ? state.stage : state.stage + ", " + state.step, state.done,
                 state.total);
  };
}

}  // namespace

int diagnose(const DiagnoseArguments& arguments) {
  const Interruptible interruptible;
  const diagnosis::Case c = load(arguments);
  if (arguments.plans) {
    fmt::print("{}",
               report::plan_summary(diagnosis::plan(c, {arguments.without, arguments.seed, {}})));
    return kOk;
  }
  std::filesystem::path folder = arguments.out;
  if (folder.empty()) folder = std::filesystem::path{"out/diagnosis"} / folder_name(c);
  report::refuse_inputs_in(folder, c.source.inputs);
  const NewFolder made{folder};
  const FolderLock lock{folder};
  report::refuse_foreign_files_in(folder);
  std::optional<Steps> steps{
      std::in_place, 2, arguments.progress ? Steps::Silent::Nowhere : Steps::Silent::OffTerminals};
  steps->begin("the diagnosis");
  diagnosis::Verdict verdict =
      diagnosis::diagnose(c, {arguments.without, arguments.seed, shown_by(*steps)});
  if (const auto recording = case_at(arguments.case_or_recording); is_run(recording)) {
    verdict.synthetic =
        report::is_of_models(recording::Reader{recording}).value_or(verdict.synthetic);
    if (arguments.against.empty()) add_mismatch_budget(recording, folder, verdict);
  }
  steps->begin("its page");
  const auto written = report::write_diagnosis(verdict, folder);
  steps.reset();  // removes its line before the results are printed
  fmt::print("{}\nreport    {}\nnumbers   {}\n", report::verdict_summary(verdict),
             written.page.string(), written.numbers.string());
  for (const auto& file : {written.improved, written.experiment, written.fragment})
    if (file) fmt::print("improved  {}\n", file->string());
  if (written.motion) fmt::print("motion    {}\n", written.motion->string());
  return kOk;
}

}  // namespace rths::app
