// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "numbers.hpp"

namespace rths::report {

/// What a page is made of: a file of report/web, and what goes where it has marks.
struct PageParts {
  std::string_view html;
  std::vector<std::string_view> styles, scripts;  ///< besides those of the plotting library
};

/// The whole page: style, drawing code and data in one file that needs nothing else.
[[nodiscard]] std::string assemble(const PageParts& parts, const Json& data);

/// Numbers travel as 32-bit floats in base64: exact enough for a picture, and small.
[[nodiscard]] Json packed(const std::vector<double>& values, double scale = 1);

}  // namespace rths::report
