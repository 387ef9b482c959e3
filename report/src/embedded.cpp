// SPDX-License-Identifier: Apache-2.0
#include "assemble.hpp"

#include <cstddef>

// Each file lies between two labels of embedded.S.in.
#define RTHS_EMBEDDED(file, constant)                 \
  extern "C" const char rths_##file##_begin[];        \
  extern "C" const char rths_##file##_end[];          \
  const std::string_view rths::report::web::constant{ \
      rths_##file##_begin, static_cast<std::size_t>(rths_##file##_end - rths_##file##_begin)};
RTHS_EMBEDDED(report_html, kReportHtml)
RTHS_EMBEDDED(report_css, kReportCss)
RTHS_EMBEDDED(report_js, kReportJs)
RTHS_EMBEDDED(theme_js, kThemeJs)
RTHS_EMBEDDED(plots_js, kPlotsJs)
RTHS_EMBEDDED(figures_js, kFiguresJs)
RTHS_EMBEDDED(diagnosis_html, kDiagnosisHtml)
RTHS_EMBEDDED(diagnosis_css, kDiagnosisCss)
RTHS_EMBEDDED(diagnosis_js, kDiagnosisJs)
RTHS_EMBEDDED(verdict_js, kVerdictJs)
RTHS_EMBEDDED(verdict_css, kVerdictCss)
RTHS_EMBEDDED(sentence_js, kSentenceJs)
RTHS_EMBEDDED(save_js, kSaveJs)
RTHS_EMBEDDED(structure_js, kStructureJs)
RTHS_EMBEDDED(where_js, kWhereJs)
RTHS_EMBEDDED(proof_js, kProofJs)
RTHS_EMBEDDED(quantities_js, kQuantitiesJs)
RTHS_EMBEDDED(charts_js, kChartsJs)
RTHS_EMBEDDED(curtain_js, kCurtainJs)
RTHS_EMBEDDED(budget_js, kBudgetJs)
RTHS_EMBEDDED(uplot_js, kUplotJs)
RTHS_EMBEDDED(uplot_css, kUplotCss)
#undef RTHS_EMBEDDED
