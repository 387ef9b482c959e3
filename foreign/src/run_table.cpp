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

/// Rows of a recorder: time, then responses.
struct RecorderTable {
  std::string file;
  std::vector<double> times;
  std::vector<std::vector<double>> responses;  ///< by column
};

std::vector<double> numbers_of(std::string_view line, const std::string& file, std::size_t number) {
  std::vector<double> row;
  for (const auto cell : cells_of(line, ' ')) {
    if (cell.empty()) continue;
    const auto value = number_of(cell);
    if (!value || !std::isfinite(*value))
      throw Error{fmt::format("{}:{}: found '{}', expected a finite number", file, number, cell)};
    row.push_back(*value);
  }
  return row;
}

RecorderTable read_recorder(const std::filesystem::path& path) {
  RecorderTable table{path.filename().string(), {}, {}};
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) throw Error{fmt::format("wrote no {}", table.file)};
  const std::string text = read_text(path);
  std::size_t number = 0;
  for (const auto line : lines_of(text)) {
    const auto row = numbers_of(line, table.file, ++number);
    if (row.empty()) continue;
    if (!table.times.empty() && row.size() != table.responses.size() + 1)
      throw Error{fmt::format("{}:{}: the row has {} numbers, expected {}", table.file, number,
                              row.size(), table.responses.size() + 1)};
    if (!table.times.empty() && row[0] <= table.times.back()) table = {table.file, {}, {}};
    table.responses.resize(row.size() - 1);
    table.times.push_back(row[0]);
    for (std::size_t i = 1; i < row.size(); ++i) table.responses[i - 1].push_back(row[i]);
  }
  if (table.times.size() < 2)
    throw Error{table.file + " has less than two rows, expected time and responses"};
  return table;
}

// Begins a table at time 0, and counts its times from the first row of the inputs.
void begin_with(const RunInputs& inputs, RecorderTable& table) {
  const double step = std::max(table.times[1] - table.times[0], inputs.time_step);
  if (table.times[0] > 0 && table.times[0] < 1.5 * step) {
    table.times.insert(table.times.begin(), 0);
    for (auto& response : table.responses) response.insert(response.begin(), response[0]);
  }
  for (double& time : table.times) time += inputs.start;
}

}  // namespace

std::vector<std::vector<double>> read_recorders(const std::filesystem::path& folder,
                                                const std::vector<RecorderColumn>& columns,
                                                const RunInputs& inputs) {
  std::vector<std::vector<double>> outputs;
  for (const auto& [file, column, factor] : columns) {
    RecorderTable table = read_recorder(folder / file);
    if (column > table.responses.size())
      throw Error{fmt::format("{} has {} columns beside time, expected at least {}", table.file,
                              table.responses.size(), column)};
    begin_with(inputs, table);
    check_times(table.times, inputs, table.file);
    outputs.push_back(at_times_of(inputs, table.times, table.responses[column - 1]));
    for (double& value : outputs.back()) value *= factor;
  }
  return outputs;
}

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
