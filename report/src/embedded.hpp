// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// Files of report/web and the plotting library, as they were when the command was built.
namespace rths::report::web {

extern const std::string_view report_html, report_css, report_js, plots_js;
extern const std::string_view verdict_css, sentence_js;
extern const std::string_view diagnosis_html, diagnosis_css, diagnosis_js;
extern const std::string_view quantities_js, charts_js, curtain_js, verdict_js, where_js, proof_js;
extern const std::string_view uplot_js, uplot_css;

}  // namespace rths::report::web
