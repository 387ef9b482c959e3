// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace rths {

/// Result of one step of the real-time path. Ordered: the worst of several wins.
enum class Status : std::uint8_t {
  Ok,             ///< completed
  Done,           ///< completed, and no work is left: this node may leave the run
  Late,           ///< completed after its deadline
  Stale,          ///< no new input; the last values were held
  LimitExceeded,  ///< a stroke, rate or force limit was reached; the value was clamped
  Fault,          ///< cannot continue; bring everything to rest
};

[[nodiscard]] constexpr Status worst(Status a, Status b) noexcept { return std::max(a, b); }

/// Name of the status, for one-line messages.
[[nodiscard]] constexpr const char* to_text(Status status) noexcept {
  constexpr const char* kNames[] = {"ok", "done", "late", "stale", "limit exceeded", "fault"};
  return kNames[static_cast<std::size_t>(status)];
}

}  // namespace rths
