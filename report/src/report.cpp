// SPDX-License-Identifier: Apache-2.0
#include <rths/report/report.hpp>

#include <fstream>
#include <utility>

#include <fmt/format.h>

#include <rths/core/replace_files.hpp>
#include <rths/report/diagnosis.hpp>

#include "companions.hpp"
#include "page.hpp"

namespace rths::report {
namespace {

// The verdict of a diagnosis in the folder of the run; null if there is none.
Json verdict_in(const std::filesystem::path& folder) {
  const auto file = folder / kVerdictFile;
  if (!std::filesystem::exists(file)) return nullptr;
  std::ifstream stream{file};
  const Json verdict = Json::parse(stream, nullptr, false);
  if (!verdict.is_object() || verdict.value("format", 0) != kVerdictFormat)
    throw Error{fmt::format("{}: not a verdict of format {}; remove it or diagnose the run again",
                            file.string(), kVerdictFormat)};
  return verdict;
}

}  // namespace

std::vector<Broken> judge_run(const std::filesystem::path& folder) {
  const Reader run{folder / kRunFile};
  for (const char* file : {kImprovedFile, kNumericalFile}) {
    if (!std::filesystem::exists(folder / file)) continue;
    const Reader reference{folder / file};
    return judge(run, &reference);
  }
  return judge(run);
}

ReportOutcome make_report(const std::filesystem::path& folder, std::vector<Broken> broken,
                          const std::filesystem::path& beside) {
  Analysis analysis = analyse(folder);
  if (!beside.empty()) add_beside(analysis, beside);
  analysis.broken = std::move(broken);
  Json numbers = numbers_of(analysis);
  numbers["diagnosis"] = verdict_in(folder);
  const ReportOutcome outcome{folder / "report.html", folder / "report.json", summary_of(analysis),
                              is_conclusive(analysis)};
  replace_file(outcome.page, page_of(analysis, numbers));
  replace_file(outcome.numbers, numbers.dump(2) + "\n");
  return outcome;
}

}  // namespace rths::report
