// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::launch {

/// What this user may not have of what real time wants, in words; empty if all is granted. @setup
[[nodiscard]] std::string missing_privileges();

}  // namespace rths::launch
