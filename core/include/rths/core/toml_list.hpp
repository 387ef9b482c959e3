// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths {

/// Texts as a TOML array, `["a", "b"]`: a value for Config::set.
[[nodiscard]] std::string toml_list(const std::vector<std::string>& texts);

}  // namespace rths
