// SPDX-License-Identifier: Apache-2.0
//
// Shared by the adapter and the trial of a plugin.
#pragma once

#include <rths_adapter.h>
#include <rths/plugin/library.hpp>
#include <rths/plugin/plugin_adapter.hpp>

namespace rths::plugin {

inline constexpr double kUntouched = 6.0221408e23;  ///< beside the outputs; no plugin writes it

[[nodiscard]] inline bool has_range(const rths_signal& signal) {
  return signal.lowest != 0 || signal.highest != 0;
}
/// Heap calls of this thread so far; 0 in a program that does not count them.   @realtime
[[nodiscard]] inline long heap_calls() noexcept {
  return rths_heap_calls != nullptr ? rths_heap_calls() : 0;
}

}  // namespace rths::plugin
