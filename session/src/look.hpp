// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <rths/session/diagnose.hpp>

#include "diagnosis_of.hpp"

namespace rths::session {

/// A test as its recording states it.
struct LiveTest {
  std::filesystem::path recording;
  double rate = 1;      ///< wall time over model time [-]
  double duration = 0;  ///< model time [s]
};

/// @throws Error if it is no recording of a test with a model and a machine that moves
[[nodiscard]] LiveTest live_test_of(const std::filesystem::path& recording);

/// Result of one look at the recording of a test.
struct Look {
  enum class Kind { Verdict, TooEarly, Paused, Failed };
  Kind kind = Kind::Failed;
  double time = 0;   ///< model time of the data [s]
  std::string text;  ///< headline and answers; what is missing; the error

  [[nodiscard]] std::string to_text() const;
  [[nodiscard]] static Look from_text(const std::string& text);
};

/// Diagnoses the data so far, as a run is diagnosed that has ended, and writes the verdict.
/// @param folder  locked by the caller
/// @param last  model time of the data of the verdict before; a test without newer data is paused
/// @throws Interrupted
[[nodiscard]] Look look_at(const LiveTest& test, const std::filesystem::path& folder,
                           const DiagnoseSettings& how, TestState state,
                           std::optional<double> last);

}  // namespace rths::session
