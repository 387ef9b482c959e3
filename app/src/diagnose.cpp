// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include <fmt/format.h>

#include <rths/session/diagnose.hpp>
#include <rths/session/live.hpp>

#include "command.hpp"
#include "figures.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

struct DiagnoseArguments {
  session::DiagnoseSettings settings;
  bool progress = false;  ///< show the progress also off a terminal
  bool plans = false;     ///< print what the case can tell, without a diagnosis
  bool json = false;
  bool is_live = false;                                ///< the case is the ring of a running test
  double interval = session::LiveSettings{}.interval;  ///< between two looks at it [s]
  FiguresArguments figures;
};

int diagnose_live(const DiagnoseArguments& arguments) {
  session::LiveSettings live{arguments.settings.source.string(), arguments.settings,
                             arguments.interval};
  session::diagnose_live(live, [](const std::string& line) {
    fmt::print("{}\n", line);
    std::fflush(stdout);
  });
  return kOk;
}

void print(const session::DiagnosisResult& result) {
  const auto& files = result.files;
  fmt::print("{}\nreport    {}\nnumbers   {}\n", report::verdict_summary(result.verdict),
             files.page.string(), files.numbers.string());
  for (const auto& file : {files.improved, files.experiment, files.fragment})
    if (file) fmt::print("improved  {}\n", file->string());
  if (files.motion) fmt::print("motion    {}\n", files.motion->string());
}

int diagnose(const DiagnoseArguments& arguments) {
  if (arguments.is_live) return diagnose_live(arguments);
  if (arguments.plans) {
    fmt::print("{}", report::plan_summary(session::plan(arguments.settings)));
    return kOk;
  }
  arguments.figures.check();
  ShownProgress progress{arguments.progress ? Steps::Silent::Nowhere : Steps::Silent::OffTerminals};
  const auto result = session::diagnose(arguments.settings, progress.functions());
  progress.end();
  if (arguments.json)
    fmt::print("{}", session::json_of(result));
  else
    print(result);
  std::fflush(stdout);
  const std::string figures = arguments.figures.write(result.files.page);
  if (!arguments.json) fmt::print("{}", figures);
  return kOk;
}

}  // namespace

void add_diagnose(CommandLine& line) {
  auto [command, a] = line.add(
      "diagnose", "Find the physics that a simulation omits, or report that none is missing",
      diagnose);
  command
      ->add_option("case", a.settings.source,
                   "Folder with a case.toml, a case file, or folder or recording of a run; with "
                   "--live the ring of a running test")
      ->required();
  command->add_option("--out", a.settings.out, "Folder for the results [out/diagnosis/<name>]");
  auto* against = command->add_option("--against", a.settings.against,
                                      "Prediction of another simulation, instead of the model's");
  command->add_option("--without", a.settings.without, "Terms to exclude, separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false);
  command->add_option("--seed", a.settings.seed, "Seed of noise and resampling")
      ->check(CLI::Range(std::int64_t{0}, kLargestSeed))
      ->capture_default_str();
  auto* plan =
      command->add_flag("--plan", a.plans, "Print what this case can tell, without a diagnosis");
  command->add_flag("--progress", a.progress,
                    "Show the progress every 30 s where standard error is not a terminal");
  auto* json = command->add_flag("--json", a.json, "One JSON document instead of lines");
  auto* live = command->add_flag("--live", a.is_live,
                                 "Diagnose a running test on its data so far, until it ends");
  auto* figures = add_figures(*command, a.figures)->excludes(plan);
  live->excludes(against)->excludes(plan)->excludes(json)->excludes(figures);
  command->add_option("--every-s", a.interval, "With --live: time from one look to the next")
      ->check(CLI::Range(1.0, 86400.0))
      ->capture_default_str()
      ->needs(live);
}

}  // namespace rths::app
