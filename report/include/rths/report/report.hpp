// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <rths/recording/recording.hpp>
#include <rths/report/judgement.hpp>

namespace rths::report {

/// Files of a run, all in one folder.
inline constexpr const char* kRunFile = "run.h5";
inline constexpr const char* kUncompensatedFile = "uncompensated.h5";
inline constexpr const char* kNumericalFile = "numerical.h5";
/// The attempt in real time of a test that was repeated in virtual time, because its host was late.
inline constexpr const char* kRealTimeFile = "real_time.h5";
inline constexpr const char* kImprovedFile =
    "improved.h5";  ///< as numerical.h5, with the improved model

/// Result of a report, for the last lines of the command.
struct ReportOutcome {
  std::filesystem::path page;     ///< report.html
  std::filesystem::path numbers;  ///< report.json
  std::string summary;            ///< a few lines for the terminal
  bool conclusive = true;         ///< false: a condition of a conclusive test is broken
};

/// Judges the run of a folder beside its numerical result, if it has one; beside the improved one,
/// if a diagnosis has improved the model.
/// @throws Error as judge   @setup
[[nodiscard]] std::vector<Broken> judge_run(const std::filesystem::path& folder);

/// Reads the recordings of a run and writes report.html, one self-contained page that needs no
/// network, and report.json with every number on it. The recording of the run is required;
/// recordings of its companion runs and the verdict of a diagnosis are used if present.
/// @param broken  the judgement of the run, see judgement.hpp
/// @param beside  the folder of another run, whose response and spectra are shown, too; or empty
/// @throws Error if a run cannot be read or contains no motion, if the other
///   lacks an axis, or verdict.json is not a verdict   @setup
[[nodiscard]] ReportOutcome make_report(const std::filesystem::path& folder,
                                        std::vector<Broken> broken,
                                        const std::filesystem::path& beside = {});

/// Whether specimen and machine of a run are models of this project. A program, plugin or FMU of
/// the user's own that represents them may drive a real machine. A program that is only the solver
/// does not matter.
/// @returns nothing if the recording holds no experiment   @throws Error as recording::roles_of
[[nodiscard]] std::optional<bool> is_of_models(const recording::Reader& run);

}  // namespace rths::report
