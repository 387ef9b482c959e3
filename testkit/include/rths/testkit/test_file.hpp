// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/recording/message_fault.hpp>
#include <rths/testkit/laboratory.hpp>

namespace rths::testkit {

/// A fault of a test, also of a whole program: kind is then kill or freeze. Times count from the
/// begin of the test, when all programs are ready.
struct PlannedFault : recording::MessageFault {
  std::string program;  ///< that plays the node
};

/// An expectation of a test; times count from its begin [s].
struct Expectation {
  double from = 0;
  double span = 0;         ///< of `within_s`, `never_within_s`
  bool is_never = false;   ///< the condition must not be met
  std::string signal;      ///< empty: the end of a program
  Condition condition{0};  ///< of the signal
  std::string program;     ///< must end with exit code 0
};

/// A recording or table that the recording of an experiment must repeat, within a tolerance.
struct Baseline {
  std::filesystem::path file;                   ///< also the folder of a run
  std::vector<std::string> signals;             ///< patterns; empty: all
  double absolute = 0, relative = 0, time = 0;  ///< tolerance [SI], [-], [s]
  std::string aligned;                          ///< signal whose delay is removed; empty: none
};

/// A test of a laboratory as a file. It has programs on a ring of its own, or an experiment.
struct TestFile {
  std::string name, map;
  double deadline = 60;  ///< of the whole test [s]
  std::vector<Program> programs;
  std::filesystem::path experiment;  ///< empty: programs
  std::string clock;                 ///< of the experiment: virtual or wall
  std::vector<std::string> changes;  ///< key=value, of the experiment
  std::vector<PlannedFault> faults;
  std::vector<Expectation> expectations;
  std::vector<Baseline> baselines;
};

/// Reads a test. @throws Error with the place of the first mistake   @setup
[[nodiscard]] TestFile read_test(const Config& file);

/// Result of a test.
struct TestResult {
  std::string failure;  ///< one line; empty: passed
  /// Names, whose logs are in the folder.
  std::vector<std::string> programs{};  // NOLINT(readability-redundant-member-init)
};

/// Runs a test. Of a failed one, the folder also gets the recording of all writes, run.h5.
/// @param folder   of the logs; must exist
/// @param command  the command rths, for an experiment
/// @param is_interrupted  ends the test early, as failed
/// @throws Error if it cannot be run
[[nodiscard]] TestResult run_test(const TestFile& test, const std::filesystem::path& folder,
                                  const std::filesystem::path& command,
                                  const std::function<bool()>& is_interrupted);

}  // namespace rths::testkit
