// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rths::adapters {

/// The OpenSees process and its deadlines.
struct OpenSeesScript {
  /// Program, script and arguments. Empty: the user starts OpenSees.
  std::vector<std::string> command;
  int processes = 1;          ///< ranks of MPI that run it together
  std::filesystem::path log;  ///< its output
  /// Files to write before the start: path, content.
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  double connect_deadline = 60;  ///< for its connection, wall time [s]
  double answer_deadline = 10;   ///< for its next message, wall time [s]
};

}  // namespace rths::adapters
