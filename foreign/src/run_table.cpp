// SPDX-License-Identifier: Apache-2.0
#include "run_table.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::foreign {
namespace {

constexpr const char* kTime = "time";
constexpr double kRoundOff = 1e-6;  // of a time step

double time_of(const RunInputs& inputs, std::size_t row) {
  return inputs.start + static_cast<double>(row) * inputs.time_step;
}

/// Columns of numbers with their names in the first line.
class CsvTable {
 public:
  explicit CsvTable(const std::filesystem::path& file) : file_{file.filename().string()} {
    const std::string text = read_text(file);
    std::size_t number = 0;
    for (const auto line : lines_of(text)) {
      ++number;
      if (trimmed(line).empty() || trimmed(line).starts_with('#')) continue;
      names_.empty() ? read_names(line) : read_row(line, number);
    }
    if (names_.empty()) throw Error{file_ + " is empty, expected a line of names, then rows"};
  }

  [[nodiscard]] const std::vector<double>* find(const std::string& name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    return found == names_.end() ? nullptr
                                 : &columns_[static_cast<std::size_t>(found - names_.begin())];
  }
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const {
    if (const auto* found = find(name)) return *found;
    throw Error{
        fmt::format("{} has no column '{}', only {}", file_, name, fmt::join(names_, ", "))};
  }
  [[nodiscard]] const std::string& file() const { return file_; }

 private:
  void read_names(std::string_view line) {
    for (const auto cell : cells_of(line, ',')) names_.emplace_back(cell);
    columns_.resize(names_.size());
  }
  void read_row(std::string_view line, std::size_t number) {
    const auto cells = cells_of(line, ',');
    if (cells.size() != names_.size())
      throw Error{fmt::format("{}:{}: the row has {} cells, expected {}", file_, number,
                              cells.size(), names_.size())};
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const auto value = number_of(cells[i]);
      if (!value || !std::isfinite(*value))
        throw Error{fmt::format("{}:{}: found '{}' in column '{}', expected a finite number", file_,
                                number, cells[i], names_[i])};
      columns_[i].push_back(*value);
    }
  }

  std::string file_;
  std::vector<std::string> names_;
  std::vector<std::vector<double>> columns_;
};

void check_times(const std::vector<double>& times, const RunInputs& inputs,
                 const std::string& file) {
  if (times.size() < 2 ||
      std::adjacent_find(times.begin(), times.end(), std::greater_equal<>{}) != times.end())
    throw Error{file + ": 'time' does not increase from row to row"};
  const double slack = kRoundOff * inputs.time_step, last = time_of(inputs, inputs.rows - 1);
  if (times.front() > inputs.start + slack || times.back() < last - slack)
    throw Error{fmt::format("{} covers {:g} to {:g} s, expected {:g} to {:g} s", file,
                            times.front(), times.back(), inputs.start, last)};
}

// Linear interpolation at the times of the inputs.
std::vector<double> at_times_of(const RunInputs& inputs, const std::vector<double>& times,
                                const std::vector<double>& values) {
  std::vector<double> result;
  std::size_t next = 1;
  for (std::size_t row = 0; row < inputs.rows; ++row) {
    const double time = std::clamp(time_of(inputs, row), times.front(), times.back());
    while (next + 1 < times.size() && times[next] < time) ++next;
    const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
    result.push_back(values[next - 1] + share * (values[next] - values[next - 1]));
  }
  return result;
}

// Whether the times are those of the rows of the inputs.
bool are_times_of(const RunInputs& inputs, const std::vector<double>& times) {
  if (times.size() != inputs.rows) return false;
  for (std::size_t row = 0; row < times.size(); ++row)
    if (!(std::abs(times[row] - time_of(inputs, row)) <= kRoundOff * inputs.time_step))
      return false;
  return true;
}

}  // namespace

std::string table_of_inputs(const RunInputs& inputs, const std::vector<std::string>& names) {
  std::string text = kTime;
  for (const auto& name : names) text += "," + name;
  text += '\n';
  for (std::size_t row = 0; row < inputs.rows; ++row) {
    text += fmt::format("{}", time_of(inputs, row));
    for (const auto& input : inputs.inputs) text += fmt::format(",{}", input[row]);
    text += '\n';
  }
  return text;
}

std::vector<std::vector<double>> read_outputs(const std::filesystem::path& file,
                                              const std::vector<std::string>& names,
                                              const RunInputs& inputs) {
  const CsvTable table{file};
  const auto* times = table.find(kTime);
  const bool interpolates = times != nullptr && !are_times_of(inputs, *times);
  if (interpolates) check_times(*times, inputs, table.file());
  std::vector<std::vector<double>> outputs;
  for (const auto& name : names) {
    const auto& values = table.column(name);
    if (!interpolates && values.size() != inputs.rows)
      throw Error{fmt::format("{} has {} rows, expected {}, or a column 'time'", table.file(),
                              values.size(), inputs.rows)};
    outputs.push_back(interpolates ? at_times_of(inputs, *times, values) : values);
  }
  return outputs;
}

}  // namespace rths::foreign
