// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace rths::bench {

/// Runs a program to its end and returns its standard output; discards its standard error.
/// @throws Error if it cannot be started; or if it exceeds the time-out, then it is killed
[[nodiscard]] std::string output_of(const std::vector<std::string>& command,
                                    std::chrono::seconds timeout);

}  // namespace rths::bench
