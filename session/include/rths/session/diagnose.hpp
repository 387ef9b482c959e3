// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/session/progress.hpp>
#include <rths/verdict/plan.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::session {

/// What to diagnose, and how.
struct DiagnoseSettings {
  std::filesystem::path source;      ///< folder of a case or of a run, a case, or a recording
  std::filesystem::path out;         ///< folder; empty: out/diagnosis/<name of the case>
  std::filesystem::path against;     ///< prediction of another simulation; empty: the model's
  std::vector<std::string> without;  ///< excluded terms
  std::uint64_t seed = 1;            ///< of noise and resampling
};

/// A verdict and its files.
struct DiagnosisResult {
  diagnosis::Verdict verdict;
  report::DiagnosisFiles files;
};

/// One JSON document; all numbers of the verdict are in its file.
[[nodiscard]] std::string json_of(const DiagnosisResult& result);

/// Finds the physics that a simulation omits and writes the verdict with its files; of a run, also
/// the mismatch budget of the response. A signal that asks the process to end stops it.
/// @throws Error if the case cannot be read, or the folder would replace other files;
///         Interrupted   @setup
DiagnosisResult diagnose(const DiagnoseSettings& settings, const Progress& progress = {});

/// Reads a case whose model is valid. @throws Error as load_case, or with the place of a wrong
/// value of the model   @setup
[[nodiscard]] diagnosis::Case checked_case(const std::filesystem::path& file);

/// What the case can tell, without a diagnosis. @throws Error if it cannot be read   @setup
[[nodiscard]] diagnosis::Plan plan(const DiagnoseSettings& settings);

}  // namespace rths::session
