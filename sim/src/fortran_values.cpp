// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

constexpr NumberStyle kStyle{.fortran = true};

std::size_t take_whole(std::string_view& text) {
  constexpr std::size_t kMost = 1000;
  std::size_t number = 0;
  while (!text.empty() && is_digit(text.front()) && number < kMost) {
    number = 10 * number + static_cast<std::size_t>(text.front() - '0');
    text.remove_prefix(1);
  }
  return number;
}

// Of columns with a fixed width, which touch without a sign: " 100.0000 101.0000" as F8.4.
// Empty: a column is no number.
std::vector<double> by_width(std::string_view line, ValueFormat format) {
  std::vector<double> values;
  for (std::size_t at = 0; at < line.size(); at += format.width) {
    auto cell = trimmed(line.substr(at, format.width));
    if (cell.empty() && trimmed(line.substr(at)).empty()) break;
    double value = 0;
    if (!take_number(cell, value, kStyle) || !cell.empty()) return {};
    values.push_back(value);
  }
  return values;
}

}  // namespace

ValueFormat stated_format(std::string_view line) {
  const auto open = line.rfind('(');
  if (open == line.npos) return {};
  std::string_view text = line.substr(open + 1);
  ValueFormat format;
  format.per_line = std::max<std::size_t>(take_whole(text), 1);
  if (text.empty() || std::string_view{"fFeEgGiIdD"}.find(text.front()) == text.npos) return {};
  text.remove_prefix(1);
  format.width = take_whole(text);
  return format.width == 0 ? ValueFormat{} : format;
}

std::vector<double> read_values(const MotionText& text, std::size_t& line, std::size_t count,
                                ValueFormat format) {
  std::vector<double> values;
  for (; values.size() < count && line < text.lines.size(); ++line) {
    const auto content = text.lines[line];
    if (trimmed(content).empty()) continue;
    std::vector<double> row;
    const auto word = add_numbers(content, kStyle, row);
    const std::size_t expected = std::min(format.per_line, count - values.size());
    const std::size_t found = row.size();
    const bool is_free = word.empty() && (format.width == 0 || found == expected);
    if (!is_free && format.width > 0) row = by_width(content, format);
    if (!is_free && row.size() != expected)
      text.fail(line, word.empty() ? fmt::format("{} values found, expected {}", found, expected)
                                   : fmt::format("'{}' is not a number", word.substr(0, 40)));
    values.insert(values.end(), row.begin(), row.end());
  }
  if (values.size() != count)
    text.fail(std::max<std::size_t>(line, 1) - 1,
              fmt::format("{} values found, expected {}", values.size(), count));
  return values;
}

}  // namespace rths::sim
