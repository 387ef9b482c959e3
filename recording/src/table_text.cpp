// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "table_formats.hpp"

namespace rths::recording {
namespace {

// The separator of a line: the first of these that it contains, else blanks.
char separator_of(std::string_view line) {
  for (const char candidate : {';', ',', '\t'})
    if (line.find(candidate) != std::string_view::npos) return candidate;
  return ' ';
}

constexpr std::string_view kDigits = "0123456789";

// True for "1,5": invalid, because the comma separates columns.
bool has_decimal_comma(std::string_view cell) {
  return cell.find_first_of(kDigits) != std::string_view::npos &&
         cell.find(',') != std::string_view::npos &&
         cell.find_first_not_of("0123456789+-eE.,; \t") == std::string_view::npos;
}

std::vector<std::string_view> split_except_commas(std::string_view line) {
  for (const char separator : {';', '\t'})
    if (line.find(separator) != std::string_view::npos) return cells_of(line, separator);
  return cells_of(line, ' ');
}

// True for "0,5;1,5": its commas separate no columns.
bool separates_halves(std::string_view line) {
  const auto parts = cells_of(line, ',');
  return has_decimal_comma(line) && !std::all_of(parts.begin(), parts.end(), [](auto cell) {
           return cell.empty() || number_of(cell).has_value();
         });
}

struct TextLine {
  std::size_t number = 0;
  std::string_view content;
};

bool has_number(const std::vector<std::string_view>& row) {
  return std::any_of(row.begin(), row.end(), [](auto cell) { return number_of(cell).has_value(); });
}

bool is_text(std::string_view cell) { return !cell.empty() && !number_of(cell).has_value(); }

bool has_text(const std::vector<std::string_view>& row) {
  return std::any_of(row.begin(), row.end(), is_text);
}

// True if at least half of the cells are numbers. The lines above the first such line hold names,
// units and other text of the logger.
bool is_row(const std::vector<std::string_view>& row) {
  const auto numbers =
      std::count_if(row.begin(), row.end(), [](auto cell) { return number_of(cell).has_value(); });
  return numbers > 0 && 2 * numbers >= static_cast<std::ptrdiff_t>(row.size());
}

// More lines with a text and a number are rows: a diagnosis needs more samples.
constexpr std::size_t kMostHeadings = 20;

class TextReader {
 public:
  explicit TextReader(const std::filesystem::path& file) : file_{file.string()} {}

  void take(std::string_view line) {
    ++line_;
    const std::string_view content = trimmed(line);
    if (content.empty() || content.front() == '#' || content.front() == '%') return;
    if (!columns.empty() && is_heading(content)) {
      above_.insert(above_.end(), headings_.begin(), headings_.end());
      headings_.clear();
      columns.clear();
    }
    if (columns.empty())
      begin(content);
    else
      add_row(cells_of(content, separator_), content);
  }
  [[nodiscard]] bool has_names_only() const { return columns.empty() && !above_.empty(); }

  Columns columns;

 private:
  void begin(std::string_view line) {
    separator_ = separator_of(line);
    const auto first = cells_of(line, separator_);
    if (separates_halves(line))
      fail_on_commas(above_.empty() ? line : split_except_commas(line)[0]);
    if (!is_row(first)) {
      above_.push_back({line_, line});
      return;
    }
    name_columns(first);
    add_row(first, line);
  }

  // Whether the lines so far, which seemed to be rows, stand above the names: "Sample rate,100".
  [[nodiscard]] bool is_heading(std::string_view line) const {
    if (headings_.empty() || headings_.size() != columns[0].values.size()) return false;
    const auto row = cells_of(line, separator_);
    return row.size() != columns.size() || std::all_of(row.begin(), row.end(), is_text);
  }

  // Names are in the topmost of the adjacent lines above with the same number of cells; lines below
  // it hold units. Empty cells at the end of the first row need no name.
  void name_columns(const std::vector<std::string_view>& first) {
    const std::size_t count = first.size();
    const auto last =
        std::find_if(first.rbegin(), first.rend(), [](auto cell) { return !cell.empty(); });
    auto fewest = static_cast<std::size_t>(first.rend() - last);
    std::vector<std::string_view> names, units;
    std::size_t line = line_;
    for (auto above = above_.rbegin(); above != above_.rend(); ++above) {
      const auto row = cells_of(above->content, separator_);
      if (row.size() < fewest || row.size() > count || (!names.empty() && has_number(row))) break;
      if (!names.empty() && units.empty()) units = names;
      names = row;
      fewest = row.size();
      names.resize(count);
      line = above->number;
    }
    for (std::size_t i = 0; i < count; ++i)
      columns.push_back({names.empty() ? std::to_string(i + 1) : std::string{names[i]}, {}, ""});
    for (std::size_t i = 0; i < units.size(); ++i) columns[i].unit = units[i];
    reject_same_names(line);
  }

  void reject_same_names(std::size_t line) const {
    for (auto column = columns.begin(); column != columns.end(); ++column)
      if (!column->name.empty() && std::any_of(columns.begin(), column, [&](const auto& other) {
            return other.name == column->name;
          }))
        throw Error{fmt::format("{}:{}: two columns are named '{}', expected different names",
                                file_, line, column->name)};
  }

  [[noreturn]] void fail_on_commas(std::string_view text) const {
    throw Error{fmt::format("{}:{}: '{}' looks like numbers with decimal commas, expected points",
                            file_, line_, text)};
  }

  void add_row(const std::vector<std::string_view>& row, std::string_view line) {
    const bool may_be_heading =
        headings_.size() == columns[0].values.size() && headings_.size() < kMostHeadings;
    if (may_be_heading && has_text(row)) headings_.push_back({line_, line});
    if (separator_ == ',' && are_halves(row))
      fail_on_commas(fmt::format("{}", fmt::join(row, ",")));
    if (row.size() != columns.size())
      throw Error{fmt::format("{}:{}: {} columns, expected {} as in the first row", file_, line_,
                              row.size(), columns.size())};
    for (std::size_t i = 0; i < row.size(); ++i) add_value(columns[i], row[i]);
  }

  void add_value(Table::Column& column, std::string_view text) const {
    const auto value = number_of(text);
    if (!value && has_decimal_comma(text)) fail_on_commas(text);
    const bool is_good = value && std::isfinite(*value);
    if (!is_good && column.trouble.empty())
      column.trouble = fmt::format("{}:{}: found '{}' in column '{}', expected a finite number",
                                   file_, line_, text, column.name);
    column.values.push_back(is_good ? *value : std::numeric_limits<double>::quiet_NaN());
  }

  std::string file_;
  std::vector<TextLine> above_;
  std::vector<TextLine> headings_;  // rows with a text, until there are more rows
  std::size_t line_ = 0;
  char separator_ = ',';
};

}  // namespace

Columns read_text_columns(const std::filesystem::path& file) {
  std::string text = read_text(file);
  if (is_lvm(text)) return read_lvm_columns(file, text);
  text = with_decimal_points(std::move(text));
  TextReader reader{file};
  for (const auto line : lines_of(text)) reader.take(line);
  if (reader.has_names_only())
    throw Error{fmt::format("{}: found column names but no rows, expected at least one row",
                            file.string())};
  return std::move(reader.columns);
}

}  // namespace rths::recording
