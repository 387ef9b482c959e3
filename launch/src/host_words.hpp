// SPDX-License-Identifier: Apache-2.0
//
// Words through which the launchers of several hosts run one test together. They cross hosts like
// all words of the ring.
#pragma once

#include <cstdint>
#include <string>

namespace rths::launch {

/// State of a test on one host.
enum class HostState : std::uint32_t {
  Absent,    ///< not started
  Starting,  ///< its nodes, or those of other hosts, are not ready
  Ready,     ///< has all nodes of the test on its ring
  Going,     ///< of the leading host: has set the time zero
  Stopping,  ///< brings its nodes to rest
  Completed,
  Failed,
  StoppedEarly  ///< brings its nodes to rest on request, before the end of the test
};

/// Longwords of a launcher: state, time zero (2), fingerprint (2), length of the text, text.
inline constexpr std::uint32_t kLauncherLongwords = 64;

[[nodiscard]] inline std::string launcher_partition(const std::string& host) {
  return "launcher." + host;
}
[[nodiscard]] inline std::string launcher_node(const std::string& host) {
  return "launcher_" + host;
}
/// One word: the number of steps of the node in virtual time, and whether it has ended.
[[nodiscard]] inline std::string turn_partition(const std::string& node) { return "turn." + node; }

}  // namespace rths::launch
