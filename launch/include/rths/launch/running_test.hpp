// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace rths::launch {

/// A test that runs on a ring of this host, and is recorded here.
struct RunningTest {
  int launcher = 0, recorder = 0;   ///< process ids
  std::filesystem::path recording;  ///< that the recorder has open for writing
};

/// Looks for a test from outside: reads the list of occupants, stores nothing into the ring. Waits
/// a few seconds for the recording of a test that begins.
/// @throws Error if there is no such ring, no launcher or no recorder on it, or if they run in
///         another PID namespace or belong to another user   @setup
[[nodiscard]] RunningTest find_running_test(const std::string& ring);

/// Process id of the launcher of the test on a ring; 0: there is none.   @setup
[[nodiscard]] int launcher_on(const std::string& ring);

}  // namespace rths::launch
