// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/table.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/recording/recording.hpp>

#include "table_formats.hpp"

namespace rths::recording {

Table Table::load(const std::filesystem::path& file) {
  Table table;
  table.file_ = file.string();
  check_is_file(file);
  if (is_hdf5(file))
    table.columns_ = read_hdf5_columns(file);
  else if (is_mat(file))
    table.columns_ = read_mat_columns(file);
  else
    table.columns_ = read_text_columns(file);
  if (table.columns_.empty())
    throw Error{
        fmt::format("{}: found no columns of numbers, expected at least one", file.string())};
  return table;
}

bool Table::is_format_of(const std::filesystem::path& file) {
  if (is_hdf5(file)) return is_foreign_hdf5(file);
  if (is_mat(file)) return true;
  std::array<char, 256> head{};
  std::ifstream stream{file, std::ios::binary};
  stream.read(head.data(), head.size());
  return is_lvm({head.data(), static_cast<std::size_t>(stream.gcount())});
}

const std::vector<double>& Table::column(const std::string& name) const {
  const Column& column = column_with_gaps(name);
  if (!column.trouble.empty()) throw Error{column.trouble};
  return column.values;
}

namespace {

// The column that is probably meant, and the first of those that there are.
std::string hint_for(const std::string& name, std::vector<std::string> known) {
  constexpr std::size_t kMost = 20;
  std::string hint = did_you_mean(name, known);
  for (const auto& other : known)
    if (other.starts_with(name + " [")) hint = fmt::format(" (its unit differs in '{}')", other);
  const std::size_t count = known.size();
  known.resize(std::min(count, kMost));
  return fmt::format("{}, expected one of {}{}", hint, fmt::join(known, ", "),
                     count > kMost ? fmt::format(" and {} others", count - kMost) : "");
}

}  // namespace

namespace {

// Parts of a name: "rec.Y(1).Data" has three.
std::vector<std::string_view> parts_of(std::string_view name) {
  std::vector<std::string_view> parts;
  while (true) {
    const auto dot = name.find('.');
    parts.push_back(name.substr(0, dot));
    if (dot == name.npos) return parts;
    name.remove_prefix(dot + 1);
  }
}

// MATLAB reads "rec(1).Y" and "rec.Y" alike if rec has one element, and "u(:)" and "u".
bool is_same(std::string_view asked, std::string_view known) {
  const auto a = parts_of(asked), b = parts_of(known);
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](auto one, auto other) {
    if (one == other) return true;
    if (!one.starts_with(other)) return false;
    one.remove_prefix(other.size());
    return one == "(1)" || one == "(:)" || one == "(:,1)" || one == "(1,:)";
  });
}

}  // namespace

const Table::Column& Table::column_with_gaps(const std::string& name) const {
  if (name.size() > 1 && name[0] == '#') {
    const auto position = std::strtoul(name.c_str() + 1, nullptr, 10);
    if (position >= 1 && position <= columns_.size()) return columns_[position - 1];
    throw Error{
        fmt::format("{}: there is no column {}, expected #1 to #{}", file_, name, columns_.size())};
  }
  std::vector<std::string> known;
  for (const auto& column : columns_) {
    if (column.name == name || column.slice == name) return column;
    known.push_back(column.name);
  }
  for (const auto& column : columns_)
    if (is_same(name, column.name) || is_same(name, column.slice)) return column;
  throw Error{
      fmt::format("{}: there is no column '{}'{}", file_, name, hint_for(name, std::move(known)))};
}

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
