// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

constexpr double kMilli = 1e-3, kMicro = 1e-6;

bool is_empty(std::string_view line) { return line.find_first_not_of(" \t\",;") == line.npos; }

bool is_comment(std::string_view line) {
  line = trimmed(line);
  return !line.empty() && (line.front() == '#' || line.front() == '%');
}

std::vector<double> numbers_of(std::string_view line) {
  std::vector<double> numbers;
  static_cast<void>(add_numbers(line, {}, numbers));
  return numbers;
}

bool starts_with_number(std::string_view line) {
  line = line.substr(std::min(line.find_first_not_of(" \t\""), line.size()));
  double number = 0;
  return take_number(line, number, {}) &&
         (line.empty() || std::string_view{" \t,;\""}.find(line.front()) != line.npos);
}

/// Rows of a file of columns, and the lines above them.
class ColumnReader {
 public:
  explicit ColumnReader(const MotionText& text) : text_{text} {}

  MotionFile read() {
    find_first_row();
    read_rows();
    if (rows_.empty())
      throw Error{text_.file.string() +
                  ": no row of numbers, expected an .AT2 file, or columns with time first"};
    check_lines_above();
    if (rows_.size() < 2) throw Error{text_.file.string() + ": fewer than two samples"};
    MotionFile motion{text_.file, "columns", 0, {}, first_ + 1};
    read_headings();
    const std::size_t first = has_time() ? 1 : 0;
    if (first == 1) motion.time_step = time_step();
    for (std::size_t i = first; i < width_; ++i) motion.columns.push_back(column(i));
    return motion;
  }

 private:
  // Numbers above a line of text, such as those of a station, are no row.
  void find_first_row() {
    for (first_ = 0; first_ < text_.lines.size(); ++first_) {
      if (is_comment(text_.lines[first_]) || !starts_with_number(text_.lines[first_])) continue;
      if (!is_row(text_.lines[first_], {})) {
        if (is_damaged_row(first_)) break;
        continue;
      }
      const std::size_t next = line_after(first_);
      if (next == text_.lines.size() || starts_with_number(text_.lines[next])) break;
    }
  }

  // A row with a word that is no number, not a heading such as "2 components".
  [[nodiscard]] bool is_damaged_row(std::size_t line) const {
    const std::size_t next = line_after(line);
    if (next == text_.lines.size() || !is_row(text_.lines[next], {})) return false;
    const auto width = numbers_of(text_.lines[next]).size();
    const auto numbers = numbers_of(text_.lines[line]).size();
    std::string words{text_.lines[line]};
    std::replace_if(
        words.begin(), words.end(), [](char c) { return c == ',' || c == ';' || c == '\t'; }, ' ');
    return cells_of(words, ' ').size() == width && numbers + 1 >= width && width > 1;
  }

  [[nodiscard]] std::size_t line_after(std::size_t line) const {
    for (++line; line < text_.lines.size(); ++line)
      if (!is_empty(text_.lines[line]) && !is_comment(text_.lines[line])) break;
    return line;
  }

  void read_rows() {
    for (std::size_t i = first_; i < text_.lines.size(); ++i) {
      const auto line = text_.lines[i];
      if (is_comment(line) || is_empty(line)) continue;
      std::vector<double> row;
      check_commas(line, i);
      if (const auto word = add_numbers(line, {}, row); !word.empty())
        text_.fail(i, fmt::format("'{}' is not a number", word.substr(0, 40)));
      if (rows_.empty()) width_ = row.size();
      if (row.size() != width_)
        text_.fail(i, fmt::format("{} columns found, expected {} as in the first row", row.size(),
                                  width_));
      rows_.push_back(std::move(row));
      lines_.push_back(i);
    }
  }

  // A row above a line of text would be lost as a heading.
  void check_lines_above() const {
    for (std::size_t i = 0; i < first_; ++i)
      if (width_ > 1 && is_row(text_.lines[i], {}) && numbers_of(text_.lines[i]).size() == width_)
        text_.fail(line_after(i), fmt::format("'{}' below a row of numbers, expected another row",
                                              text_.lines[line_after(i)].substr(0, 60)));
  }

  // Of "0,005,1,5", no reader knows whether it has two columns or four.
  void check_commas(std::string_view line, std::size_t number) const {
    const bool has_commas_only = line.find_first_of(".;\t") == line.npos;
    if (has_commas_only && line.find(',') != line.npos && are_halves(cells_of(line, ',')))
      text_.fail(number,
                 fmt::format("'{}' looks like numbers with decimal commas, expected points, or "
                             "columns separated by semicolons",
                             line.substr(0, 60)));
    for (const char separator : {';', '\t'})
      for (const auto cell : cells_of(line, separator))
        if (line.find(separator) != line.npos && cell.find(',') != cell.npos && is_row(cell, {}))
          text_.fail(number, fmt::format("'{}' looks like a number with a decimal comma, or with "
                                         "thousands, expected a point",
                                         cell));
    for (const char separator : {',', ';'}) {
      auto cells = cells_of(line, separator);
      if (cells.size() < 2) continue;
      cells.pop_back();  // a row may end with a separator
      if (std::ranges::any_of(cells, [](auto cell) { return cell.empty(); }))
        text_.fail(number, "an empty cell, expected a number");
    }
  }

  // Cells of a heading; one per column, otherwise empty.
  [[nodiscard]] std::vector<std::string> cells_of_heading(std::string_view line) const {
    line = trimmed(line);
    while (!line.empty() && (line.front() == '#' || line.front() == '%')) line.remove_prefix(1);
    line = trimmed(line);
    const bool has_marks = text_.lines[first_].find_first_of(",;\t") != std::string_view::npos;
    for (const char separator : {';', ',', '\t', ' '}) {
      if (separator == ' ' && has_marks) break;
      std::vector<std::string> cells;
      for (const auto cell : cells_of(line, separator)) {
        const bool is_unit = separator == ' ' && !cells.empty() && !cell.empty() &&
                             (cell.front() == '[' || cell.front() == '(');
        if (is_unit)
          cells.back() += " " + std::string{cell};
        else
          cells.emplace_back(cell);
      }
      if (cells.size() > width_ && cells.back().empty()) cells.pop_back();
      const bool is_sentence =
          std::ranges::any_of(cells, [](const auto& cell) { return cell == "in" || cell == "of"; });
      if (cells.size() == width_ && !is_sentence) return cells;
    }
    return {};
  }

  // The lowest line with a cell per column has names; one with units alone may stand below.
  void read_headings() {
    headings_.assign(width_, "");
    names_ = first_;
    if (width_ == 1) return read_only_heading();
    std::vector<std::string> units(width_);
    for (std::size_t i = first_; i-- > 0;) {
      const auto cells = cells_of_heading(text_.lines[i]);
      if (cells.empty() || is_empty(text_.lines[i])) continue;
      headings_ = cells;
      names_ = i;
      if (!has_units_only(cells) || !units[0].empty()) break;
      units = std::exchange(headings_, std::vector<std::string>(width_));
    }
    for (std::size_t i = 0; i < width_; ++i) add_unit(units[i], headings_[i]);
  }

  static void add_unit(const std::string& unit, std::string& heading) {
    if (unit.empty()) return;
    if (!heading.empty()) heading += " ";
    heading += unit.find_first_of("[(") == std::string::npos ? "[" + unit + "]" : unit;
  }

  // Above one column, the lowest line with a unit, otherwise the lowest line.
  void read_only_heading() {
    for (std::size_t i = first_; i-- > 0;) {
      const std::string line{trimmed(text_.lines[i])};
      if (is_empty(line)) continue;
      const bool has_unit = stated_unit(line).unit != nullptr;
      if (headings_[0].empty() || has_unit) headings_[0] = line;
      if (has_unit) return;
    }
  }

  static bool has_units_only(const std::vector<std::string>& cells) {
    return std::ranges::all_of(cells, [](const std::string& cell) {
      if (cell.empty() || cell == "-") return true;
      const std::size_t size = cell.size();
      const bool has_brackets = size > 2 && (cell[0] == '[' || cell[0] == '(');
      return find_unit(has_brackets ? cell.substr(1, size - 2) : cell) != nullptr;
    });
  }

  // "Units: cm/s2" above the names counts for columns that state none.
  [[nodiscard]] StatedUnit common_unit() const {
    for (std::size_t i = 0; i < names_; ++i) {
      const std::string line = in_small_letters(text_.lines[i]);
      const auto says = [&](const char* word) { return line.find(word) != std::string::npos; };
      const bool is_of_site = says("vs30") || says("shear") || says("wave");
      if (is_of_site ||
          !(says("unit") || says("acc") || says("pga") || says("vel") || says("displ")))
        continue;
      const StatedUnit stated = stated_unit(line);
      const bool is_of_peak = says("max") || says("peak") || says("pga");
      // Whether the peak has the unit of the values is unclear.
      if (stated.unit != nullptr && is_of_peak)
        return {nullptr, stated.unit->name == "g" ? "" : line};
      if (stated.unit != nullptr) return stated;
    }
    return mentioned_unit();
  }

  // Of "# a in m/s2" or "ns {m/s2}", no rule says which column has this unit.
  [[nodiscard]] StatedUnit mentioned_unit() const {
    for (std::size_t i = 0; i < first_; ++i)
      if (mentions_other_acceleration(text_.lines[i]))
        return {nullptr, std::string{trimmed(text_.lines[i].substr(0, 100))}};
    return {};
  }

  // [s]
  [[nodiscard]] double unit_of_time() const {
    const std::string heading = in_small_letters(headings_[0]);
    const auto begin = heading.find_last_of("[(_ /");
    if (begin == std::string::npos) return 1;
    const auto unit = heading.substr(begin + 1, heading.find_last_not_of("]).") - begin);
    const auto is = [&](std::initializer_list<std::string_view> names) {
      return std::ranges::find(names, unit) != names.end();
    };
    const auto open = std::min(heading.find_first_of("[("), begin);
    const bool has_factor = heading.find_first_of("0123456789", open) < begin;  // "[0.1 s]"
    if (!has_factor && is({"ms", "msec", "msecs", "millisecond", "milliseconds"})) return kMilli;
    if (!has_factor && is({"µs", "us"})) return kMicro;
    const bool is_second = !has_factor && is({"", "-", "s", "sec", "secs", "second", "seconds"});
    const bool is_other = has_factor || heading[begin] == '[' ||
                          (heading[begin] == '(' && unit.find_first_of("0123456789") == 0) ||
                          is({"min", "minutes", "h", "hours", "days", "sample", "samples"});
    if (!is_second && is_other)
      throw Error{fmt::format("{}: the unit '{}' of the time '{}' is unknown, expected s or ms",
                              text_.file.string(), unit, headings_[0])};
    return 1;
  }

  [[nodiscard]] bool is_named_time() const {
    const std::string name =
        in_small_letters(headings_[0].substr(0, headings_[0].find_first_of(" _[(/")));
    return name == "t" || name == "time" || name == "zeit" || name == "temps" || name == "tiempo";
  }

  // The first of several columns, unless its heading states acceleration.
  [[nodiscard]] bool has_time() const {
    if (width_ == 1) {
      if (is_named_time())
        throw Error{text_.file.string() + ": a column of time alone, expected acceleration too"};
      return false;
    }
    const StatedUnit stated = stated_unit(headings_[0]);
    const bool states_motion =
        stated.unit != nullptr && stated.unit->kind != MotionUnit::Kind::Other;
    return is_named_time() || !states_motion;
  }

  [[nodiscard]] std::string other_first_column() const {
    return headings_[0].empty() || is_named_time()
               ? ""
               : fmt::format(": the first column is '{}', expected time", headings_[0]);
  }

  [[nodiscard]] double time_step() const {
    const double unit = unit_of_time();
    std::vector<double> stamps;
    for (const auto& row : rows_) stamps.push_back(unit * row[0]);
    const auto steps = time_steps(stamps);
    if (!(steps.step > 0))
      text_.fail(lines_.back(), "time does not increase" + other_first_column());
    if (steps.wrong)
      text_.fail(lines_[*steps.wrong], "time is not equally spaced" + other_first_column());
    return steps.step;
  }

  [[nodiscard]] MotionColumn column(std::size_t index) const {
    MotionColumn column{headings_[index], stated_unit(headings_[index]), {}};
    if (column.stated.unit == nullptr && column.stated.unknown.empty())
      column.stated = common_unit();
    for (const auto& row : rows_) column.values.push_back(row[index]);
    return column;
  }

  const MotionText& text_;
  std::size_t first_ = 0, width_ = 0;  // line of the first row; its columns
  std::size_t names_ = 0;              // line of the names; `first_`: none
  std::vector<std::vector<double>> rows_;
  std::vector<std::size_t> lines_;  // of the rows
  std::vector<std::string> headings_;
};

}  // namespace

MotionFile read_columns(const MotionText& text) { return ColumnReader{text}.read(); }

}  // namespace rths::sim
