// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <rths/diagnosis/against.hpp>
#include <rths/diagnosis/diagnose.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>

#include "commands.hpp"
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
  return std::filesystem::is_regular_file(path) && path.extension() != ".toml";
}

// The recording in the folder of a run; otherwise the path itself.
std::filesystem::path case_at(const std::filesystem::path& path) {
  const bool is_folder_of_run = std::filesystem::exists(path / report::kRunFile) &&
                                !std::filesystem::exists(path / "case.toml");
  return is_folder_of_run ? path / report::kRunFile : path;
}

diagnosis::Case load(const DiagnoseArguments& arguments) {
  diagnosis::Case c = diagnosis::load_case(case_at(arguments.case_or_recording));
  return arguments.against.empty() ? c
                                   : diagnosis::with_prediction(std::move(c), arguments.against);
}

}  // namespace

int diagnose(const DiagnoseArguments& arguments) {
  const diagnosis::Case c = load(arguments);
  std::filesystem::path folder = arguments.out;
  if (folder.empty()) folder = std::filesystem::path{"out/diagnosis"} / folder_name(c);
  create_folder(folder);
  const FolderLock lock{folder};
  std::optional<Steps> steps{std::in_place, 2};
  steps->begin("the diagnosis");
  diagnosis::Verdict verdict = diagnosis::diagnose(c, {arguments.without, arguments.seed});
  // In this version, specimen and machine of a run are models.
  verdict.synthetic = verdict.synthetic || is_run(case_at(arguments.case_or_recording));
  steps->begin("its page");
  const auto written = report::write_diagnosis(verdict, folder);
  steps.reset();  // removes its line before the results are printed
  fmt::print("{}\nreport    {}\nnumbers   {}\n", report::verdict_summary(verdict),
             written.page.string(), written.numbers.string());
  if (written.fragment) fmt::print("improved  {}\n", written.fragment->string());
  if (written.motion) fmt::print("motion    {}\n", written.motion->string());
  return kOk;
}

}  // namespace rths::app
