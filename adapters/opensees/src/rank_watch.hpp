// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::adapters {

/// The ranks of a script that keep the others waiting, and why: those that are stopped, that sleep,
/// or that have not begun to analyze while others have. Ranks that wait for others are busy. Takes
/// 0.1 s.
/// @param launcher  process that has started them by `run_inside`
/// @returns "rank 1 is stopped by a signal"; empty: all ranks compute
[[nodiscard]] std::string hanging_ranks(int launcher);

}  // namespace rths::adapters
