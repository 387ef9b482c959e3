// SPDX-License-Identifier: Apache-2.0
#include "embedded.hpp"

#include <cstddef>

// Symbols of embedded.S.in, which holds the bytes of each file between two labels.
#define RTHS_EMBEDDED(name)                       \
  extern "C" const char rths_##name##_begin[];    \
  extern "C" const char rths_##name##_end[];      \
  const std::string_view rths::report::web::name{ \
      rths_##name##_begin, static_cast<std::size_t>(rths_##name##_end - rths_##name##_begin)};
RTHS_EMBEDDED(report_html)
RTHS_EMBEDDED(report_css)
RTHS_EMBEDDED(report_js)
RTHS_EMBEDDED(plots_js)
RTHS_EMBEDDED(diagnosis_html)
RTHS_EMBEDDED(diagnosis_css)
RTHS_EMBEDDED(diagnosis_js)
RTHS_EMBEDDED(verdict_js)
RTHS_EMBEDDED(verdict_css)
RTHS_EMBEDDED(sentence_js)
RTHS_EMBEDDED(where_js)
RTHS_EMBEDDED(proof_js)
RTHS_EMBEDDED(quantities_js)
RTHS_EMBEDDED(charts_js)
RTHS_EMBEDDED(curtain_js)
RTHS_EMBEDDED(uplot_js)
RTHS_EMBEDDED(uplot_css)
#undef RTHS_EMBEDDED
