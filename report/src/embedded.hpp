// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Contents of the files of report/web and of the plotting library, embedded when the command is
/// built.
namespace rths::report::web {

extern const std::string_view kReportHtml, kReportCss, kReportJs;
extern const std::string_view kThemeJs, kPlotsJs, kFiguresJs;
extern const std::string_view kVerdictCss, kSentenceJs;
extern const std::string_view kDiagnosisHtml, kDiagnosisCss, kDiagnosisJs;
extern const std::string_view kQuantitiesJs, kChartsJs, kCurtainJs, kVerdictJs, kWhereJs, kProofJs,
    kBudgetJs;
extern const std::string_view kUplotJs, kUplotCss;

}  // namespace rths::report::web
