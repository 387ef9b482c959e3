// SPDX-License-Identifier: Apache-2.0
#include "case_source.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

namespace rths::diagnosis {
namespace {

using recording::Table;

constexpr std::string_view kExpected = "expected \"column [unit]\"";

std::string trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return std::string{text};
}

// " in load.csv" after the unit.
std::string read_file(const Config& table, const std::string& key, const std::string& rest) {
  constexpr std::string_view kIn = "in ";
  if (rest.empty()) return "";
  if (!rest.starts_with(kIn) || rest.size() == kIn.size())
    table.fail(key, fmt::format("'{}' follows the unit, expected nothing or \"in file\"", rest));
  return trimmed(std::string_view{rest}.substr(kIn.size()));
}

// "before [unit] behind"
struct Brackets {
  std::string before, within, whole, behind;
};

std::optional<Brackets> brackets_of(const std::string& text) {
  const auto close = text.rfind(']');
  const auto open = close == std::string::npos ? close : text.rfind('[', close);
  if (open == std::string::npos) return std::nullopt;
  return Brackets{trimmed(text.substr(0, open)), text.substr(open + 1, close - open - 1),
                  trimmed(text.substr(0, close + 1)), trimmed(text.substr(close + 1))};
}

struct Segments : Brackets {
  memmap::Unit unit{"1", 1, 0};
};

Segments segments_of(const Config& table, const std::string& key) {
  const std::string text = table.text(key);
  const auto brackets = brackets_of(text);
  if (!brackets) table.fail(key, fmt::format("'{}' names no unit, {}", text, kExpected));
  return {*brackets, table.placed(key, [&] { return memmap::parse_unit(brackets->within); })};
}

double number_of(const Config& table, const std::string& key, const std::string& text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size())
    table.fail(key, fmt::format("'{}' is not a number", text));
  return value;
}

Trouble trouble_in(const Table::Column& column) {
  const auto& values = column.values;
  const auto bad =
      std::find_if(values.begin(), values.end(), [](double value) { return std::isnan(value); });
  return {column.trouble, bad - values.begin()};
}

bool is_other_unit_of_its_quantity(const std::string& stated, const memmap::Unit& unit) {
  try {
    const auto found = memmap::parse_unit(stated);
    return found.si == unit.si &&
           (std::abs(found.scale / unit.scale - 1) > 1e-9 || found.offset != unit.offset);
  } catch (const Error&) {
    return false;  // not a unit that is known here
  }
}

// A factor in the unit of the case is a calibration, and so is a unit of another quantity.
void check_unit(const Table::Column& column, const Source& source,
                const std::filesystem::path& file) {
  const std::string& unit = source.unit_text;
  if (unit.empty() || std::string_view{"0123456789.+-"}.find(unit[0]) != std::string_view::npos)
    return;
  const auto heading = brackets_of(column.name);
  for (const std::string& stated : {column.unit, heading ? heading->within : ""})
    if (is_other_unit_of_its_quantity(stated, source.unit))
      throw Error{fmt::format("{}: column '{}' is in {}, found [{}], expected [{}]", file.string(),
                              column.name, stated, unit, stated)};
}

bool has(const Table& table, const std::string& name) {
  const auto& columns = table.columns();
  return std::any_of(columns.begin(), columns.end(),
                     [&](const auto& column) { return column.name == name; });
}

}  // namespace

Source source_of(const Config& table, const std::string& key) {
  const Segments text = segments_of(table, key);
  Source source{key,
                text.before,
                text.whole,
                std::nullopt,
                text.unit,
                text.within,
                read_file(table, key, text.behind)};
  if (text.before.empty())
    table.fail(key, fmt::format("'{}' names no column, {}", table.text(key), kExpected));
  if (text.before.front() != '=') return source;
  const double number = number_of(table, key, trimmed(text.before.substr(1)));
  source.number = text.unit.scale * number + text.unit.offset;
  return source;
}

std::pair<double, std::string> deviation_of(const Config& table, const std::string& key) {
  const Segments text = segments_of(table, key);
  return {number_of(table, key, text.before) * text.unit.scale, text.unit.si};
}

const Table& Files::at(const std::filesystem::path& file) {
  const auto known = tables_.find(file);
  if (known != tables_.end()) return known->second;
  return tables_.emplace(file, Table::load(file)).first->second;
}

std::vector<std::filesystem::path> Files::paths() const {
  std::vector<std::filesystem::path> paths;
  for (const auto& [path, table] : tables_) paths.push_back(path);
  return paths;
}

std::vector<double> Files::column(const Config& table, const Source& source,
                                  const std::filesystem::path& file, Trouble& trouble) {
  return table.placed(source.key, [&] {
    const Table& columns = at(source.file.empty() ? file : table.resolve(source.file));
    const bool is_negated =
        source.column.front() == '-' && !has(columns, source.column) && !has(columns, source.whole);
    const std::size_t sign = is_negated ? 1 : 0;
    const std::string whole = source.whole.substr(sign);
    const Table::Column& column =
        columns.column_with_gaps(has(columns, whole) ? whole : trimmed(source.column.substr(sign)));
    check_unit(column, source, source.file.empty() ? file : table.resolve(source.file));
    trouble = trouble_in(column);
    std::vector<double> values;
    values.reserve(column.values.size());
    for (const double value : column.values) {
      const double si = source.unit.scale * value + source.unit.offset;
      values.push_back(is_negated ? -si : si);
    }
    return values;
  });
}

}  // namespace rths::diagnosis
