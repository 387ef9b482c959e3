// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

#include <rths/identification/progress.hpp>
#include <rths/launch/run.hpp>

namespace rths::session {

struct RunResult;

/// What a session tells while it works. Functions may be empty.
struct Progress {
  std::function<void(const std::string& line)> note;  ///< for the user; from any thread
  std::function<void()> checked;  ///< the experiment of a run is read and checked; nothing runs yet
  std::function<void(const launch::Progress&)> run;  ///< of a test, a few times per second
  std::function<void(const RunResult&)> recorded;    ///< a test has ended; it is not judged yet
  /// The next of several long steps begins.
  std::function<void(int number, int count, const std::string& name)> step;
  diagnosis::DiagnosisProgress::Show fits;  ///< of a diagnosis
};

}  // namespace rths::session
