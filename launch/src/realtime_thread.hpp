// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::launch {

/// Gives the calling thread real-time scheduling, locked memory and exact timers. Only this file
/// does so. A missing privilege is not an error.
/// @param priority  1…99
/// @returns the missing privileges as text; empty if none
[[nodiscard]] std::string make_realtime(int priority);
/// Gives it real-time scheduling alone. @returns 0, or the error number
int prefer_realtime(int priority);

/// Priorities within a run: the host probe has the highest; those of the nodes are in NodeSettings.
inline constexpr int kProbePriority = 70;
inline constexpr int kGatewayPriority = 20;  ///< of a test on several hosts

}  // namespace rths::launch
