// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "numbers.hpp"

namespace rths::report {

/// The complete page of a run: style, scripts and data in one self-contained file.
[[nodiscard]] std::string page_of(const Analysis& analysis, const Json& numbers);

}  // namespace rths::report
