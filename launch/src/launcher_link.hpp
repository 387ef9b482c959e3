// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "silence.hpp"

namespace rths::launch {

/// The line that the launcher sends to its nodes several times per second.
inline constexpr const char* kAlive = "alive";

/// A node's link to its launcher: lines through standard input and output.
class LauncherLink {
 public:
  /// Waits for the next line, at most `longest`. Lines that only show that the launcher runs are
  /// left out.
  [[nodiscard]] std::optional<std::string> receive_line(Duration longest);
  /// Why the launcher cannot control this node: "the launcher vanished", when its end of the pipe
  /// is closed, or "the launcher is silent". Call it several times per second, after
  /// `receive_line`.
  [[nodiscard]] std::optional<std::string> find_trouble(TimePoint now);
  static void send_line(const std::string& line);

 private:
  [[nodiscard]] std::optional<std::string> take_line();

  std::string received_;
  std::uint64_t lines_ = 0;
  Silence silence_;
  bool vanished_ = false;
};

}  // namespace rths::launch
