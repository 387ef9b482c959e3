// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/recording/table.hpp>

namespace rths::recording {

using Columns = std::vector<Table::Column>;

[[nodiscard]] Columns read_text_columns(const std::filesystem::path& file);
[[nodiscard]] Columns read_hdf5_columns(const std::filesystem::path& file);
[[nodiscard]] Columns read_mat_columns(const std::filesystem::path& file);
/// True if the file begins like a MAT file, version 4 to 7.3.
[[nodiscard]] bool is_mat(const std::filesystem::path& file);

/// Adds an array stored column by column: a single column as name, several as name(1), name(2), …
inline void add_array(Columns& columns, const std::string& name, std::size_t rows,
                      const std::vector<double>& values) {
  const std::size_t count = rows == 0 ? 0 : values.size() / rows;
  for (std::size_t c = 0; c < count; ++c) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(c * rows);
    columns.push_back({count == 1 ? name : name + "(" + std::to_string(c + 1) + ")",
                       {begin, begin + static_cast<std::ptrdiff_t>(rows)},
                       ""});
  }
}

}  // namespace rths::recording
