// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace rths::report {

/// Files of a run, all in one folder.
inline constexpr const char* kRunFile = "run.h5";
inline constexpr const char* kUncompensatedFile = "uncompensated.h5";
inline constexpr const char* kNumericalFile = "numerical.h5";
inline constexpr const char* kImprovedFile =
    "improved.h5";  ///< as numerical.h5, with what was found

/// What a report came to, for the command's last lines.
struct ReportOutcome {
  std::filesystem::path page;     ///< report.html
  std::filesystem::path numbers;  ///< report.json
  std::string summary;            ///< a few lines for the terminal
  bool conclusive = true;         ///< false: the host was late too often for real-time claims
};

/// Reads the recordings of a run and writes report.html, one self-contained page that needs no
/// network, and report.json with every number on it. The recording of the run itself is needed;
/// those of its companions, and the verdict of a diagnosis, are used if they are there.
/// @throws Error if the run cannot be read or holds no motion, or the verdict is none   @setup
[[nodiscard]] ReportOutcome make_report(const std::filesystem::path& folder);

}  // namespace rths::report
