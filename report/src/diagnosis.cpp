// SPDX-License-Identifier: Apache-2.0
#include <rths/report/diagnosis.hpp>

#include <algorithm>
#include <system_error>

#include <fmt/format.h>

#include <rths/report/report.hpp>

#include "write_file.hpp"

namespace rths::report {
namespace {

// CSV with a column for each channel, as rths diagnose reads it.
std::string table_of(const diagnosis::TestMotion& motion) {
  std::string text = "time";
  std::size_t rows = 0;
  for (const auto& [role, values] : motion.channels) {
    text += "," + role;
    rows = std::max(rows, values.size());
  }
  text += '\n';
  for (std::size_t row = 0; row < rows; ++row) {
    text += fmt::format("{:.8g}", static_cast<double>(row) * motion.time_step);
    for (const auto& [role, values] : motion.channels) text += fmt::format(",{:.8g}", values[row]);
    text += '\n';
  }
  return text;
}

}  // namespace

DiagnosisFiles write_diagnosis(const diagnosis::Verdict& verdict,
                               const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw Error{folder.string() + ": cannot create the folder: " + error.message()};
  const bool is_of_run = std::filesystem::exists(folder / kRunFile);
  DiagnosisFiles files{
      folder / (is_of_run ? kDiagnosisPage : "report.html"), folder / kVerdictFile, {}, {}};
  const auto fragment = folder / kFragmentFile, motion = folder / "next_test.csv";
  // Proposals of an earlier diagnosis must not remain beside a verdict without any.
  for (const auto& file : {fragment, motion}) std::filesystem::remove(file, error);
  write_file(files.page, verdict_page(verdict));
  write_file(files.numbers, verdict_json(verdict));
  if (!verdict.fragment.empty()) {
    write_file(fragment, verdict.fragment);
    files.fragment = fragment;
  }
  if (!verdict.next_motion.channels.empty()) {
    write_file(motion, table_of(verdict.next_motion));
    files.motion = motion;
  }
  return files;
}

}  // namespace rths::report
