// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::launch {

/// Real-time privileges that this user lacks, as text; empty if none.   @setup
[[nodiscard]] std::string missing_privileges();

}  // namespace rths::launch
