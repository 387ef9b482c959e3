// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rths::web {

/// Contents of the files of this folder, embedded when it is built.
extern const std::string_view kPageCss;
extern const std::string_view kThemeJs, kPlotsJs, kFiguresJs, kQuantitiesJs, kChartsJs, kSaveJs;

/// Files that make a page: the HTML file, and the files that replace its marks.
struct PageSections {
  std::string_view html;
  std::vector<std::string_view> styles, scripts;  ///< in addition to those of uPlot
};

/// The complete page: style, scripts and data in one self-contained file.
/// @param data  JSON; every "<" in it is escaped
[[nodiscard]] std::string assemble(const PageSections& sections, std::string data);

}  // namespace rths::web
