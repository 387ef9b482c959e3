// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rths::report {

/// In the first line of each table of predictions: tells it from other files.
inline constexpr const char* kTableMark =
    "). before, after: predictions fitted without and with the named terms; residual:";

/// report.html; in the folder of a run diagnosis.html.
[[nodiscard]] std::filesystem::path page_in(const std::filesystem::path& folder);

/// Whether a file is a table of predictions that a diagnosis has written.
[[nodiscard]] bool is_prediction(const std::filesystem::path& file);
/// Whether a file is what a killed diagnosis has left of a table or an improved model.
[[nodiscard]] bool is_draft(const std::filesystem::path& file);
/// Whether something else has the name of a table.
[[nodiscard]] bool is_foreign(const std::filesystem::path& table);

}  // namespace rths::report
