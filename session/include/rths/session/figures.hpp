// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>

namespace rths::session {

/// @throws Error if the folder has files, and figures may not be written beside them   @setup
void check_figures_folder(const std::filesystem::path& folder, bool replaces);

/// Writes each figure of a page as PNG, SVG and CSV, with the names of the page's own buttons. The
/// page's script draws them, in a headless Chromium.
/// @param folder   is made if needed; files of the same names are replaced
/// @param scratch  a folder for the browser's own files, which the caller removes
/// @returns files, three for each figure
/// @throws Error if there is no Chromium, it does not draw in time, or a file cannot be written:
/// the
///         folder has none of the figures then; Interrupted   @setup
std::size_t write_figures(const std::filesystem::path& page, const std::filesystem::path& folder,
                          const std::filesystem::path& scratch);

}  // namespace rths::session
