// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::plant {

/// Memory that this process can still use: of the machine, of its control group, and within its
/// own limit [byte].   @setup
[[nodiscard]] double available_memory();

/// @param what   needs the memory
/// @throws Error if it is more than available   @setup
void require_memory(const std::string& what, double bytes);

}  // namespace rths::plant
