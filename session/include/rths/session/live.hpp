// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <rths/session/diagnose.hpp>

namespace rths::session {

/// The rate from which a test is slow enough for a verdict to come before its end.
inline constexpr double kSlowRate = 10;  ///< wall time over model time [-]

/// How to diagnose a test that runs.
struct LiveSettings {
  std::string ring;      ///< of the test
  DiagnoseSettings how;  ///< without source; `out` empty: out/diagnosis/<ring>
  double interval = 60;  ///< from one look to the next [s]; a longer look delays the next one
};

/// Diagnoses a running test again and again, on its recording so far, and once more when it has
/// ended. Only reads: stores nothing into the ring, and each look runs in a child process of idle
/// priority, which runs when no other process wants the processor. Each look replaces the files of
/// the one before as a whole.
/// @param tell  gets a text for each look, of several lines for a verdict, and a line for what is
///              unusual about the test
/// @throws Error if no test runs on the ring, its recording is none that can be diagnosed, another
///         process writes to the folder, or the last look has no verdict; Interrupted   @setup
void diagnose_live(const LiveSettings& settings,
                   const std::function<void(const std::string&)>& tell);

}  // namespace rths::session
