// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include <rths/core/clock.hpp>

namespace rths::launch {

/// Measures for how long a process has given no sign of life, from looks of the watching process.
///
/// A host that stops both processes is not silence: the time between two looks counts as one look
/// at most, so only a watching process that keeps looking finds silence.
class Silence {
 public:
  /// @param signs  number of the signs of life so far
  /// @returns the silence that was observed until now
  Duration look(TimePoint now, std::uint64_t signs) {
    if (signs != signs_)
      observed_ = Duration{0};
    else if (looked_)
      observed_ += std::min(now - *looked_, kLongestLook);
    signs_ = signs;
    looked_ = now;
    return observed_;
  }

 private:
  static constexpr Duration kLongestLook = std::chrono::milliseconds{100};
  std::uint64_t signs_ = 0;
  std::optional<TimePoint> looked_;
  Duration observed_{0};
};

}  // namespace rths::launch
