// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "numbers.hpp"

/// Contents of the files of report/web and of the plotting library, embedded when the command is
/// built.
namespace rths::report::web {

extern const std::string_view kReportHtml, kReportCss, kReportJs;
extern const std::string_view kThemeJs, kPlotsJs, kFiguresJs, kSaveJs;
extern const std::string_view kVerdictCss, kSentenceJs, kStructureJs;
extern const std::string_view kDiagnosisHtml, kDiagnosisCss, kDiagnosisJs;
extern const std::string_view kQuantitiesJs, kChartsJs, kCurtainJs, kVerdictJs, kWhereJs, kProofJs,
    kBudgetJs;
extern const std::string_view kUplotJs, kUplotCss;

}  // namespace rths::report::web

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

/// At most `most` of the values, evenly spaced: more than that a screen cannot show.
[[nodiscard]] std::vector<double> thinned(const std::vector<double>& values, std::size_t most);
/// Distance of the values that `thinned` keeps.
[[nodiscard]] std::size_t stride_of(std::size_t count, std::size_t most);

}  // namespace rths::report
