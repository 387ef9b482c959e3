// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/session/diagnose.hpp>

#include "commands.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

void print(const session::DiagnosisResult& result) {
  const auto& files = result.files;
  fmt::print("{}\nreport    {}\nnumbers   {}\n", report::verdict_summary(result.verdict),
             files.page.string(), files.numbers.string());
  for (const auto& file : {files.improved, files.experiment, files.fragment})
    if (file) fmt::print("improved  {}\n", file->string());
  if (files.motion) fmt::print("motion    {}\n", files.motion->string());
}

}  // namespace

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

}  // namespace rths::app
