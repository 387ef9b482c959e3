// SPDX-License-Identifier: Apache-2.0
#include <rths/report/report.hpp>

#include <fstream>

#include <rths/core/error.hpp>

#include "page.hpp"

namespace rths::report {
namespace {

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream{file, std::ios::binary};
  stream << text;
  stream.close();
  if (!stream) throw Error{file.string() + ": cannot be written"};
}

}  // namespace

ReportOutcome make_report(const std::filesystem::path& folder) {
  const Analysis analysis = analyse(folder);
  const Json numbers = numbers_of(analysis);
  const ReportOutcome outcome{folder / "report.html", folder / "report.json", summary_of(analysis),
                              is_conclusive(analysis)};
  write(outcome.page, page_of(analysis, numbers));
  write(outcome.numbers, numbers.dump(2) + "\n");
  return outcome;
}

}  // namespace rths::report
