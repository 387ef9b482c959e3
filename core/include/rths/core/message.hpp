// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths {

/// Writes a text to standard error, as it is. A lost message ends no program: standard error may be
/// closed, or a log on a full disk.   @any_thread
void write_message(const std::string& text) noexcept;

}  // namespace rths
