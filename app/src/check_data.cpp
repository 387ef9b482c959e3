// SPDX-License-Identifier: Apache-2.0
#include "checks.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/command_line/program.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/experiment/check.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/table.hpp>
#include <rths/sim/motion_file.hpp>

namespace rths::app {
namespace {

std::string describe_values(const recording::Table::Column& column) {
  const auto bad = std::count_if(column.values.begin(), column.values.end(),
                                 [](double value) { return std::isnan(value); });
  std::string text = fmt::format("'{}'", printable(column.name));
  if (!column.unit.empty()) text += fmt::format(" [{}]", printable(column.unit));
  if (!column.slice.empty()) text += fmt::format(", {}", printable(column.slice));
  text += fmt::format(": {} values", column.values.size());
  if (static_cast<std::size_t>(bad) == column.values.size()) return text + ", none is a number";
  text += ", " + range_of(column.values);
  return bad == 0 ? text : fmt::format("{}, {} without a number", text, bad);
}

std::string describe_column(const sim::MotionFile& motion, int column) {
  const auto& of = motion.columns[static_cast<std::size_t>(column - 1)];
  const bool is_acceleration =
      of.stated.unknown.empty() &&
      (of.stated.unit == nullptr || of.stated.unit->kind == sim::MotionUnit::Kind::Acceleration);
  std::string text = motion.has_one_component() ? "" : fmt::format(" of column {}", column);
  if (of.values.size() != motion.columns[0].values.size())
    text += fmt::format(" with {} samples", of.values.size());
  if (!of.heading.empty()) text += fmt::format(" '{}'", printable(of.heading.substr(0, 60)));
  if (!is_acceleration) return "no acceleration" + text;
  double peak = 0;
  for (const double value : sim::acceleration_in_g(motion, column))
    peak = std::max(peak, std::abs(value));
  const auto unit =
      of.stated.unit == nullptr ? "no unit, read as g" : fmt::format("in {}", of.stated.unit->name);
  return fmt::format("{:.4g} g{} ({})", peak, text, unit);
}

int check_motion(const std::string& file) {
  const auto [motion, remarks] = experiment::check_motion_file(file);
  std::string text = fmt::format("{}: ground motion ({}), {} samples, interval {:g} s, peak ", file,
                                 motion.format, motion.columns[0].values.size(), motion.time_step);
  for (std::size_t i = 0; i < motion.columns.size(); ++i)
    text += (i == 0 ? "" : ", ") + describe_column(motion, static_cast<int>(i) + 1);
  fmt::print("{}\n", text);
  for (const auto& remark : remarks) write_message(fmt::format("rths: {}: {}\n", file, remark));
  return kOk;
}

// Whether headings of a file name other quantities than those of the ground, such as a force.
bool is_log(const recording::Table& table) {
  bool has_other = false;
  for (const auto& column : table.columns()) {
    const auto stated = sim::stated_unit(
        column.unit.empty() ? column.name : fmt::format("{} [{}]", column.name, column.unit));
    if (stated.unit != nullptr && stated.unit->kind == sim::MotionUnit::Kind::Acceleration)
      return false;
    const bool is_time = &column == &table.columns().front();
    has_other = has_other ||
                (!is_time &&
                 (!stated.unknown.empty() ||
                  (stated.unit != nullptr && stated.unit->kind == sim::MotionUnit::Kind::Other)));
  }
  return has_other;
}

// The columns of a log; empty if the file is none.
std::optional<recording::Table> read_log(const std::string& file) {
  try {
    auto table = recording::Table::load(file);
    return is_log(table) ? std::optional{std::move(table)} : std::nullopt;
  } catch (const Error&) {
    return std::nullopt;
  }
}

int describe_table(const std::string& file, const recording::Table& table) {
  fmt::print("{}: table of {} columns for the records of a case\n", file, table.columns().size());
  for (const auto& column : table.columns()) fmt::print("  {}\n", describe_values(column));
  return kOk;
}

}  // namespace

// "from 0 to 29.99 in steps of 0.01" for time, otherwise the range.
std::string range_of(const std::vector<double>& values) {
  double least = INFINITY, most = -INFINITY;
  for (const double value : values) {
    least = std::min(least, value);
    most = std::max(most, value);
  }
  std::string text = fmt::format("{:.5g} to {:.5g}", least, most);
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  for (std::size_t i = 1; i < values.size(); ++i)
    if (!(std::abs(values[i] - values[0] - static_cast<double>(i) * step) < 0.02 * step))
      return text;
  return step > 0 ? fmt::format("{} in steps of {:.5g}", text, step) : text;
}

int check_table(const std::string& file) {
  return describe_table(file, recording::Table::load(file));
}

// Columns of ground motion, unless their headings say otherwise.
int check_columns(const std::string& file) {
  try {
    return check_motion(file);
  } catch (const Error&) {
    const auto log = read_log(file);
    if (!log) throw;
    return describe_table(file, *log);
  }
}

}  // namespace rths::app
