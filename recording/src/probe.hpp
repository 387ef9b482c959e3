// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>

namespace rths::recording {

/// Calls `act`, which reads or repairs a file with a library that a damaged file can crash or
/// delay, in a child process.
/// @returns its result   @throws Error, also for an error of `act`, if the child crashed, took too
///          much time or too much memory
[[nodiscard]] bool in_child(const std::filesystem::path& file, const std::function<bool()>& act);

/// Calls `read` in a child process, once for each version of a file. The caller reads the same
/// afterwards, in this process.
/// @throws Error as `in_child`. A size that is wrong by far is an error in the child only, whose
///         memory is limited.
void probe(const std::filesystem::path& file, const std::function<void()>& read);

}  // namespace rths::recording
