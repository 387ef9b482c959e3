// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::launch {

/// Makes the calling thread one that the host runs before others: real-time scheduling, locked
/// memory, exact timers. The one place where that is done.
/// @param priority  1…99
/// @returns what could not be had, in words; empty if all could. Nothing fails for lack of it.
[[nodiscard]] std::string make_realtime(int priority);

/// Priorities within a run: the host probe above all, then those whose lateness costs most.
inline constexpr int kProbePriority = 70;
[[nodiscard]] int priority_of(const std::string& adapter);

}  // namespace rths::launch
