// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <rths/diagnosis/verdict.hpp>

namespace rths::report {

/// Version of the format of verdict.json, docs/verdict.md. Bumped when a key goes away or means
/// something else; new keys do not bump it.
inline constexpr int kVerdictFormat = 1;

/// A verdict's numbers.
inline constexpr const char* kVerdictFile = "verdict.json";
/// A verdict's page in the folder of a run, where report.html is the run's own.
inline constexpr const char* kDiagnosisPage = "diagnosis.html";

/// The improved model.
inline constexpr const char* kFragmentFile = "improved.toml";

/// Files that a verdict is written into, all in one folder.
struct DiagnosisFiles {
  std::filesystem::path page;                     ///< report.html, or diagnosis.html
  std::filesystem::path numbers;                  ///< verdict.json
  std::optional<std::filesystem::path> fragment;  ///< improved.toml; none: nothing to improve
  std::optional<std::filesystem::path> motion;    ///< next_test.csv; none: no test is proposed
};

/// Every number of a verdict as JSON, as docs/verdict.md says.
[[nodiscard]] std::string verdict_json(const diagnosis::Verdict& verdict);
/// The same for a terminal: the sentence, then a short table.
[[nodiscard]] std::string verdict_summary(const diagnosis::Verdict& verdict);
/// The same as one page that needs no network.
[[nodiscard]] std::string verdict_page(const diagnosis::Verdict& verdict);

/// Writes all of it into a folder, which is made if it is not there. What an earlier diagnosis left
/// there is replaced.
/// @throws Error if a file cannot be written   @setup
DiagnosisFiles write_diagnosis(const diagnosis::Verdict& verdict,
                               const std::filesystem::path& folder);

}  // namespace rths::report
