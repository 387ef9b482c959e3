// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/session/diagnose.hpp>

#include "command.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

struct DiagnoseArguments {
  session::DiagnoseSettings settings;
  bool progress = false;  ///< show the progress also off a terminal
  bool plans = false;     ///< print what the case can tell, without a diagnosis
  bool json = false;
};

void print(const session::DiagnosisResult& result) {
  const auto& files = result.files;
  fmt::print("{}\nreport    {}\nnumbers   {}\n", report::verdict_summary(result.verdict),
             files.page.string(), files.numbers.string());
  for (const auto& file : {files.improved, files.experiment, files.fragment})
    if (file) fmt::print("improved  {}\n", file->string());
  if (files.motion) fmt::print("motion    {}\n", files.motion->string());
}

int diagnose(const DiagnoseArguments& arguments) {
  if (arguments.plans) {
    fmt::print("{}", report::plan_summary(session::plan(arguments.settings)));
    return kOk;
  }
  ShownProgress progress{arguments.progress ? Steps::Silent::Nowhere : Steps::Silent::OffTerminals};
  const auto result = session::diagnose(arguments.settings, progress.functions());
  progress.end();
  if (arguments.json)
    fmt::print("{}", session::json_of(result));
  else
    print(result);
  return kOk;
}

}  // namespace

void add_diagnose(CommandLine& line) {
  auto [command, a] = line.add(
      "diagnose", "Find the physics that a simulation omits, or report that none is missing",
      diagnose);
  command
      ->add_option("case", a.settings.source,
                   "Folder with a case.toml, a case file, or folder or recording of a run")
      ->required();
  command->add_option("--out", a.settings.out, "Folder for the results [out/diagnosis/<name>]");
  command->add_option("--against", a.settings.against,
                      "Prediction of another simulation, instead of the model's");
  command->add_option("--without", a.settings.without, "Terms to exclude, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--seed", a.settings.seed, "Seed of noise and resampling")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed))
      ->capture_default_str();
  command->add_flag("--plan", a.plans, "Print what this case can tell, without a diagnosis");
  command->add_flag("--progress", a.progress,
                    "Show the progress every 30 s where standard error is not a terminal");
  command->add_flag("--json", a.json, "One JSON document instead of lines");
}

}  // namespace rths::app
