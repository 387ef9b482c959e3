// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::scramnet {

/// One line on standard error, once for each `where`, a literal: a vendor's call can only return a
/// number.
void complain_once(const char* where, const char* message) noexcept;

}  // namespace rths::scramnet
