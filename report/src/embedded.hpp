// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace rths::report {

/// Files of report/web and the plotting library, as they were when the command was built.
[[nodiscard]] std::string_view page_template();
[[nodiscard]] std::string_view page_style();
[[nodiscard]] std::string_view page_script();
[[nodiscard]] std::string_view plot_library_script();
[[nodiscard]] std::string_view plot_library_style();

}  // namespace rths::report
