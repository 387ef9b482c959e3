// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <rths/verdict/plan.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::report {

/// Version of the format of verdict.json, docs/verdict.md. Increases if a key is removed or changes
/// its meaning, not for new keys.
inline constexpr int kVerdictFormat = 1;

/// Numbers of a verdict.
inline constexpr const char* kVerdictFile = "verdict.json";
/// Page of a verdict in the folder of a run, where report.html is the page of the run.
inline constexpr const char* kDiagnosisPage = "diagnosis.html";

/// The improved model.
inline constexpr const char* kFragmentFile = "improved.toml";

/// Folder of the improved case, in the folder of a verdict.
inline constexpr const char* kImprovedFolder = "improved";
inline constexpr const char* kImprovedCase = "case.toml";
inline constexpr const char* kImprovedExperiment = "experiment.toml";

/// Folder of the tables of measurements and predictions, in the folder of a verdict.
inline constexpr const char* kPredictionFolder = "predictions";

/// The motion of the proposed next test.
inline constexpr const char* kMotionFile = "next_test.csv";

/// Files of a written verdict, all in one folder.
struct DiagnosisFiles {
  std::filesystem::path page;                       ///< report.html, or diagnosis.html
  std::filesystem::path numbers;                    ///< verdict.json
  std::optional<std::filesystem::path> fragment;    ///< improved.toml; none: no named terms
  std::optional<std::filesystem::path> improved;    ///< improved/case.toml; none: no named terms
  std::optional<std::filesystem::path> experiment;  ///< improved/experiment.toml, of a run
  std::vector<std::filesystem::path> predictions;   ///< predictions/<record>.csv
  std::optional<std::filesystem::path> motion;      ///< next_test.csv; none: no test is proposed
};

/// Every number of a verdict as JSON; format in docs/verdict.md.
[[nodiscard]] std::string verdict_json(const diagnosis::Verdict& verdict);
/// The headline of a verdict, then its three answers, a line each.
[[nodiscard]] std::string answers_text(const diagnosis::Verdict& verdict);
/// A verdict for a terminal: headline, answers, the sentence, then a short table.
[[nodiscard]] std::string verdict_summary(const diagnosis::Verdict& verdict);
/// The plan of a diagnosis for a terminal.
[[nodiscard]] std::string plan_summary(const diagnosis::Plan& plan);
/// A verdict as one self-contained page that needs no network.
[[nodiscard]] std::string verdict_page(const diagnosis::Verdict& verdict);

/// @throws Error if a diagnosis into the folder would replace one of the files, also through a
///   symbolic link, or if the file is inside its `predictions` or `improved`   @setup
void refuse_inputs_in(const std::filesystem::path& folder,
                      const std::vector<std::filesystem::path>& inputs);
/// @throws Error if the folder has files named like those of a diagnosis, but no verdict of an
///   earlier one   @setup
void refuse_foreign_files_in(const std::filesystem::path& folder);

/// Writes all files of a verdict into a folder, which it creates if needed. Files of an earlier
/// diagnosis are replaced. Other files in `predictions` and `improved` are kept; a table whose name
/// is taken by one of them gets a number.
/// @throws Error if a file cannot be written   @setup
DiagnosisFiles write_diagnosis(const diagnosis::Verdict& verdict,
                               const std::filesystem::path& folder);

}  // namespace rths::report
