// SPDX-License-Identifier: Apache-2.0
//
// LVM, the text format of LabVIEW: a header of the file, then segments, each with a header, a line
// of names and rows. See "Specification for the LabVIEW Measurement File" of National Instruments.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "table_formats.hpp"

namespace rths::recording {
namespace {

constexpr std::string_view kStart = "LabVIEW Measurement", kEnd = "***End_of_Header***";
constexpr std::string_view kTime = "X_Value", kRemarks = "Comment";

using Cells = std::vector<std::string_view>;
using Header = std::map<std::string, Cells, std::less<>>;

bool is_blank(const Cells& cells) {
  return std::all_of(cells.begin(), cells.end(), [](auto cell) { return cell.empty(); });
}

class LvmReader {
 public:
  LvmReader(const std::filesystem::path& file, std::string_view text)
      : file_{file.string()}, lines_{lines_of(text)} {
    for (const auto line : lines_)
      if (line.starts_with("Separator") && line.size() > 9) separator_ = line[9];
  }

  Columns read() {
    const Header header = read_header();
    const auto decimal = header.find("Decimal_Separator");
    has_commas_ = decimal != header.end() && decimal->second[0] == ",";
    const auto headings = header.find("Multi_Headings");
    has_further_packets_ = headings != header.end() && headings->second[0] == "No";
    while (skip_blank_lines()) read_segment();
    if (columns_.empty()) fail("found no segment, expected names and rows below the headers");
    return std::move(columns_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw Error{fmt::format("{}:{}: {}", file_, std::min(line_ + 1, lines_.size()), problem)};
  }

  [[nodiscard]] Cells cells() const { return cells_of(lines_[line_], separator_); }

  // Data of add-ons between special marks are no header.
  bool skip_blank_lines() {
    bool is_special = false;
    for (; line_ < lines_.size(); ++line_) {
      const auto first = cells()[0];
      if (first == "***Start_Special***") is_special = true;
      if (!is_special && !is_blank(cells())) return true;
      if (first == "***End_Special***") is_special = false;
    }
    return false;
  }

  // Up to its end mark: keys, and one value or one per channel.
  Header read_header() {
    Header header;
    while (skip_blank_lines()) {
      Cells row = cells();
      ++line_;
      if (row[0] == kEnd) return header;
      const std::string key{row[0]};
      row.erase(row.begin());
      row.resize(std::max<std::size_t>(row.size(), 1));
      header[key] = std::move(row);
    }
    fail(fmt::format("found no end of the header, expected '{}'", kEnd));
  }

  [[nodiscard]] std::optional<double> number(std::string_view cell) const {
    std::string text{cell};
    if (has_commas_) std::replace(text.begin(), text.end(), ',', '.');
    return number_of(text);
  }

  void read_segment() {
    const Header header = read_header();
    if (!skip_blank_lines()) fail("found no names below the header, expected one per channel");
    read_names();
    const std::size_t before = columns_[0].values.size(), first = line_;
    for (; line_ < lines_.size() && is_row(); ++line_) add_row();
    if (!has_times_) add_times(header, before);
    check_samples(header, columns_[0].values.size() - before);
    check_order(before, first);
  }

  // "X_Value" may stand before each channel. The last column may hold comments.
  void read_names() {
    Columns named;
    std::size_t times = 0;
    Cells names = cells();
    while (!names.empty() && (names.back().empty() || names.back() == kRemarks)) names.pop_back();
    if (names.empty()) fail("found no names of channels");
    positions_.clear();
    for (std::size_t i = 0; i < names.size(); ++i) {
      std::string name{names[i]};
      if (name == kTime && ++times > 1) name += fmt::format("({})", times);
      for (const auto& other : named)
        if (other.name == name)
          fail(fmt::format("two columns are named '{}', expected different names", name));
      named.push_back({name, {}, ""});
      positions_.push_back(i);
    }
    ++line_;
    has_times_ = names[0] == kTime && line_ < lines_.size() && !cells()[0].empty();
    if (names[0] != kTime) named.insert(named.begin(), {std::string{kTime}, {}, ""});
    if (names[0] != kTime) positions_.insert(positions_.begin(), 0);
    adopt(std::move(named));
  }

  void adopt(Columns named) {
    const auto is_same = [](const auto& one, const auto& other) { return one.name == other.name; };
    if (columns_.empty())
      columns_ = std::move(named);
    else if (!std::equal(columns_.begin(), columns_.end(), named.begin(), named.end(), is_same))
      fail("the segment has other channels than the first one, expected the same");
  }

  // Otherwise the header of a further segment.
  [[nodiscard]] bool is_row() const {
    const Cells row = cells();
    if (is_blank(row)) return false;
    return row[0].empty() || number(row[0]).has_value();
  }

  void add_row() {
    const Cells row = cells();
    for (std::size_t i = has_times_ ? 0 : 1; i < columns_.size(); ++i)
      add_value(columns_[i], positions_[i] < row.size() ? row[positions_[i]] : std::string_view{});
    if (!has_times_) columns_[0].values.push_back(0);
  }

  void add_value(Table::Column& column, std::string_view cell) const {
    const auto value = number(cell);
    const bool is_good = value && std::isfinite(*value);
    if (!is_good && column.trouble.empty())
      column.trouble = fmt::format("{}:{}: found '{}' in column '{}', expected a finite number",
                                   file_, line_ + 1, cell, column.name);
    column.values.push_back(is_good ? *value : std::numeric_limits<double>::quiet_NaN());
  }

  // The one value that all channels have.
  [[nodiscard]] double common(const Header& header, std::string_view key) const {
    const auto found = header.find(key);
    if (found == header.end()) fail(fmt::format("the segment has no X values and no '{}'", key));
    const auto value = number(found->second[0]);
    for (const auto cell : found->second)
      if (!value || (!cell.empty() && number(cell) != value))
        fail(fmt::format("'{}' of the channels differ, expected a column of X values", key));
    return *value;
  }

  void add_times(const Header& header, std::size_t before) {
    const double start = common(header, "X0"), step = common(header, "Delta_X");
    for (std::size_t i = before; i < columns_[0].values.size(); ++i)
      columns_[0].values[i] = start + static_cast<double>(i - before) * step;
  }

  void check_samples(const Header& header, std::size_t rows) const {
    const auto found = header.find("Samples");
    if (found == header.end()) return;
    double most = 0;
    for (const auto cell : found->second) most = std::max(most, number(cell).value_or(0));
    const auto found_rows = static_cast<double>(rows);
    if (found_rows < most || (found_rows > most && !has_further_packets_))
      fail(fmt::format("{} rows found, expected Samples = {:g}", rows, most));
  }

  void check_order(std::size_t before, std::size_t first) {
    const auto& times = columns_[0].values;
    if (before == 0 || before == times.size() || times[before] > times[before - 1]) return;
    line_ = first;
    fail(
        fmt::format("a further segment begins at {:g} s, after {:g} s: expected one segment, or "
                    "X values that go on",
                    times[before], times[before - 1]));
  }

  std::string file_;
  std::vector<std::string_view> lines_;
  std::size_t line_ = 0;  // from 0
  char separator_ = '\t';
  bool has_commas_ = false, has_times_ = true;
  bool has_further_packets_ = false;    // below the header of the first one
  Columns columns_;                     // the first one is X_Value
  std::vector<std::size_t> positions_;  // of the columns in a row
};

}  // namespace

bool is_lvm(std::string_view text) {
  const auto lines = lines_of(text.substr(0, 200));
  return !lines.empty() && trimmed(lines[0]).starts_with(kStart);
}

Columns read_lvm_columns(const std::filesystem::path& file, std::string_view text) {
  return LvmReader{file, text}.read();
}

}  // namespace rths::recording
