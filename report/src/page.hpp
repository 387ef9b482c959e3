// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "numbers.hpp"

namespace rths::report {

/// The whole page: style, drawing code and data in one file that needs nothing else.
[[nodiscard]] std::string page_of(const Analysis& analysis, const Json& numbers);

}  // namespace rths::report
