// SPDX-License-Identifier: Apache-2.0
#include "embedded.hpp"

#include <cstddef>

// Symbols of embedded.S.in, which holds the bytes of each file between two labels.
#define RTHS_EMBEDDED(name)             \
  extern "C" const char name##_begin[]; \
  extern "C" const char name##_end[];
RTHS_EMBEDDED(rths_page_template)
RTHS_EMBEDDED(rths_page_style)
RTHS_EMBEDDED(rths_page_script)
RTHS_EMBEDDED(rths_uplot_script)
RTHS_EMBEDDED(rths_uplot_style)
#undef RTHS_EMBEDDED

namespace rths::report {
namespace {

std::string_view between(const char* begin, const char* end) {
  return {begin, static_cast<std::size_t>(end - begin)};
}

}  // namespace

std::string_view page_template() {
  return between(rths_page_template_begin, rths_page_template_end);
}
std::string_view page_style() { return between(rths_page_style_begin, rths_page_style_end); }
std::string_view page_script() { return between(rths_page_script_begin, rths_page_script_end); }
std::string_view plot_library_script() {
  return between(rths_uplot_script_begin, rths_uplot_script_end);
}
std::string_view plot_library_style() {
  return between(rths_uplot_style_begin, rths_uplot_style_end);
}

}  // namespace rths::report
