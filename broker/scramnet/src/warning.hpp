// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::scramnet {

/// Prints one line on standard error, once for each `where` (a literal). The vendor's calls can
/// only return a number.
void warn_once(const char* where, const char* message) noexcept;

}  // namespace rths::scramnet
