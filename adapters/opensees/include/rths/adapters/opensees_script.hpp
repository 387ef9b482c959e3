// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rths::adapters {

/// A node of a script whose acceleration is recorded.
struct OpenSeesFloor {
  std::string name;
  int node = 0;                   ///< its tag
  std::array<int, 2> dofs{1, 2};  ///< along long and lat, from 1; 0: none
};

/// The OpenSees process and its deadlines.
struct OpenSeesScript {
  /// Program, script and arguments. Empty: the user starts OpenSees.
  std::vector<std::string> command;
  int processes = 1;  ///< ranks of MPI that run it together
  std::vector<OpenSeesFloor> floors;
  std::filesystem::path log;  ///< its output
  /// Files to write before the start: path, content.
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  double connect_deadline = 60;  ///< for its connection, wall time [s]
  double answer_deadline = 10;   ///< for its next message, wall time [s]
};

}  // namespace rths::adapters
