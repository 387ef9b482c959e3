// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/adapters/adapter_runner.hpp>

namespace rths::launch {

/// Start of a line with times of steps, from a node to the launcher.
inline constexpr const char* kTimesLine = "times ";

/// Sends the times of the steps of a node to the launcher, in microseconds.
void send_times(const adapters::StepTimes& times);
/// Adds the times of a line, without its start. Ignores what is not a number.
void read_times(const std::string& text, adapters::StepTimes& times);

}  // namespace rths::launch
