// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <rths/recording/table.hpp>

namespace rths::recording {

using Columns = std::vector<Table::Column>;

[[nodiscard]] Columns read_text_columns(const std::filesystem::path& file);
[[nodiscard]] Columns read_hdf5_columns(const std::filesystem::path& file);
/// False for recordings of runs, also for those that were not closed.
[[nodiscard]] bool is_foreign_hdf5(const std::filesystem::path& file);
[[nodiscard]] Columns read_mat_columns(const std::filesystem::path& file);
/// True if the file begins like a MAT file, version 4 to 7.3.
[[nodiscard]] bool is_mat(const std::filesystem::path& file);

/// True if a text begins like an LVM file of LabVIEW.
[[nodiscard]] bool is_lvm(std::string_view text);
/// @throws Error with file:line, found and expected
[[nodiscard]] Columns read_lvm_columns(const std::filesystem::path& file, std::string_view text);

/// Adds a matrix stored column by column. A recording has more samples than signals: the signals
/// are the rows if these are longer than the columns. One signal is called `name`, several name(1),
/// name(2), …
void add_matrix(Columns& columns, const std::string& name, std::size_t rows,
                const std::vector<double>& values);

}  // namespace rths::recording
