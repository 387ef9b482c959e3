// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace rths::bench {

enum class GateResult { Pass, Fail, Inconclusive, NotJudged, Missing };

[[nodiscard]] const char* to_text(GateResult result) noexcept;

/// Result of several rows: that of the worst one. Rows that are not judged do not count.
/// @param rows  each with a `gate_result`
template <class Rows>
[[nodiscard]] GateResult worst_of(const Rows& rows) {
  const auto any = [&](GateResult wanted) {
    return std::any_of(rows.begin(), rows.end(),
                       [&](const auto& row) { return row.gate_result == wanted; });
  };
  if (any(GateResult::Fail)) return GateResult::Fail;
  return any(GateResult::Inconclusive) ? GateResult::Inconclusive : GateResult::Pass;
}

}  // namespace rths::bench
