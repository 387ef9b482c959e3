// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace rths {

/// What one step of the real-time path came to. Ordered: the worst of several wins.
enum class Status : std::uint8_t {
  Ok,             ///< done as asked
  Done,           ///< done, and there is nothing left to do: this node may leave the run
  Late,           ///< done, but after its deadline
  Stale,          ///< nothing new to work on; the last values were held
  LimitExceeded,  ///< a stroke, rate or force limit was hit; the value was clamped
  Fault,          ///< cannot go on; bring everything to rest
};

[[nodiscard]] constexpr Status worst(Status a, Status b) noexcept { return std::max(a, b); }

/// The status in words, for one-line messages.
[[nodiscard]] constexpr const char* to_text(Status status) noexcept {
  switch (status) {
    case Status::Ok:
      return "ok";
    case Status::Done:
      return "done";
    case Status::Late:
      return "late";
    case Status::Stale:
      return "stale";
    case Status::LimitExceeded:
      return "limit exceeded";
    case Status::Fault:
      return "fault";
  }
  return "unknown";
}

}  // namespace rths
