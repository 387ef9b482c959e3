// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "numbers.hpp"

namespace rths::report {

/// Files of report/web that make a page: the HTML file, and the files that replace its marks.
struct PageSections {
  std::string_view html;
  std::vector<std::string_view> styles, scripts;  ///< in addition to those of the plotting library
};

/// The complete page: style, scripts and data in one self-contained file.
[[nodiscard]] std::string assemble(const PageSections& sections, const Json& data);

/// Numbers as 32-bit floats in base64: precise enough for a picture, and small.
[[nodiscard]] Json packed(const std::vector<double>& values, double scale = 1);

}  // namespace rths::report
