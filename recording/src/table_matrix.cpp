// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "table_formats.hpp"

namespace rths::recording {

void add_matrix(Columns& columns, const std::string& name, std::size_t rows,
                const std::vector<double>& values) {
  constexpr std::size_t kMostColumns = 100'000;
  if (rows == 0) return;
  const std::size_t width = values.size() / rows;
  const bool are_rows = width > rows;
  const std::size_t signals = are_rows ? rows : width, samples = are_rows ? width : rows;
  if (columns.size() + signals > kMostColumns)
    throw Error{fmt::format("more than {} columns of numbers", kMostColumns)};
  for (std::size_t s = 0; s < signals; ++s) {
    Table::Column column{name, {}, ""};
    if (signals > 1) {
      column.name = fmt::format("{}({})", name, s + 1);
      column.slice =
          are_rows ? fmt::format("{}({},:)", name, s + 1) : fmt::format("{}(:,{})", name, s + 1);
    }
    column.values.reserve(samples);
    for (std::size_t i = 0; i < samples; ++i)
      column.values.push_back(values[are_rows ? i * rows + s : s * rows + i]);
    columns.push_back(std::move(column));
  }
}

}  // namespace rths::recording
