// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace rths::bench {

/// Runs a program to its end and returns what it wrote to standard output; the rest is discarded.
/// @throws Error if it cannot be started, or takes too long and is killed
[[nodiscard]] std::string output_of(const std::vector<std::string>& command,
                                    std::chrono::seconds patience);

}  // namespace rths::bench
