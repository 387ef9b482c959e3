// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace rths::adapters {

/// OpenSees itself, and how long it is waited for.
struct OpenSeesScript {
  /// Program, script and arguments. Empty: somebody else starts it.
  std::vector<std::string> command;
  std::filesystem::path log;  ///< what it says goes there
  /// Written before it starts: path, content.
  std::vector<std::pair<std::filesystem::path, std::string>> files;
  double connect_deadline = 60;  ///< for it to come, on the host's clock [s]
  double answer_deadline = 10;   ///< for it to say something, on the host's clock [s]
};

}  // namespace rths::adapters
