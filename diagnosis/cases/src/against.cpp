// SPDX-License-Identifier: Apache-2.0
#include <rths/cases/against.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/recording/table.hpp>

namespace rths::diagnosis {
namespace {

using recording::Table;

constexpr double kRoundOff = 1e-6;  // of a time step

bool is_prediction(const Channel& channel) { return is_predicted(channel.role); }

// Accepted names of a column: "force.long", "predicted.force.long", "srmd.long.force.fbk".
std::vector<std::string> names_of(const std::string& role) {
  std::vector<std::string> names{role, prediction_of(role)};
  const auto dot = role.find('.');
  if (dot == std::string::npos) return names;
  const std::string quantity = role.substr(0, dot), axis = role.substr(dot + 1);
  const std::string word = quantity == "displacement"   ? "displ"
                           : quantity == "acceleration" ? "accel"
                                                        : quantity;
  names.push_back(fmt::format("{}.{}", word, axis));
  names.push_back(fmt::format("srmd.{}.{}.fbk", axis, word));
  return names;
}

using Column = Table::Column;

const Column* column_of(const Table& table, const std::string& role) {
  for (const auto& name : names_of(role))
    for (const auto& column : table.columns())
      if (column.name == name) return &column;
  return nullptr;
}

void require_finite(const std::vector<double>& values, const Column& column,
                    const std::string& file) {
  if (std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) return;
  throw Error{
      column.trouble.empty()
          ? fmt::format("{}: '{}' is not finite in each row, expected numbers", file, column.name)
          : column.trouble};
}

const std::vector<double>& time_of(const Table& table, const std::string& file) {
  for (const auto& column : table.columns()) {
    if (column.name != "time") continue;
    const auto& time = column.values;
    require_finite(time, column, file);
    if (time.size() < 2 ||
        std::adjacent_find(time.begin(), time.end(), std::greater_equal<>{}) != time.end())
      throw Error{file + ": 'time' does not increase from row to row"};
    return time;
  }
  throw Error{file + ": has no column 'time', expected the time of each row in seconds"};
}

// Cuts the record to the span of the simulation.
void cut(Record& record, double from, double to) {
  const double slack = kRoundOff * record.time_step;
  const auto at = [&](double time) { return (time - record.start) / record.time_step; };
  const auto last_sample = static_cast<double>(record.samples()) - 1;
  const double first = std::max(0.0, std::ceil(at(from - slack)));
  const double last = std::min(last_sample, std::floor(at(to + slack)));
  if (last - first < 1)
    throw Error{
        fmt::format("covers {:.13g} to {:.13g} s, expected an overlap with {:.13g} to {:.13g} s",
                    from, to, record.start, record.start + last_sample * record.time_step)};
  const auto begin = static_cast<std::size_t>(first), end = static_cast<std::size_t>(last) + 1;
  for (auto& channel : record.channels)
    channel.values = {channel.values.begin() + static_cast<std::ptrdiff_t>(begin),
                      channel.values.begin() + static_cast<std::ptrdiff_t>(end)};
  record.start += first * record.time_step;
  const auto moved = [&](std::size_t sample) { return std::clamp(sample, begin, end) - begin; };
  std::erase_if(record.gaps,
                [&](const auto& gap) { return gap.second <= begin || gap.first + 1 >= end; });
  for (auto& gap : record.gaps)
    gap = {moved(gap.first), std::min(moved(gap.second), end - begin - 1)};
  if (!record.quiet) return;
  record.quiet = {moved(record.quiet->first), moved(record.quiet->second)};
  if (record.quiet->first == record.quiet->second) record.quiet.reset();
}

// Linear interpolation at the times of a record.
std::vector<double> at_times_of(const Record& record, const std::vector<double>& time,
                                const std::vector<double>& values) {
  std::vector<double> result;
  for (std::size_t i = 0; i < record.samples(); ++i) {
    const double t = std::clamp(record.start + static_cast<double>(i) * record.time_step,
                                time.front(), time.back());
    const auto next =
        std::max<std::ptrdiff_t>(1, std::lower_bound(time.begin(), time.end(), t) - time.begin());
    const auto k = static_cast<std::size_t>(next);
    const double fraction = (t - time[k - 1]) / (time[k] - time[k - 1]);
    result.push_back(values[k - 1] + fraction * (values[k] - values[k - 1]));
  }
  return result;
}

void add_predictions(Record& record, const Table& table, const std::vector<double>& time,
                     const std::string& file) {
  std::vector<Channel> predictions;
  std::string roles;
  for (const auto& channel : record.channels) {
    if (is_prediction(channel)) continue;
    roles += (roles.empty() ? "" : ", ") + channel.role;
    // A command is an input of the test, not a prediction.
    const auto* column = column_of(table, channel.role);
    if (column == nullptr || channel.role.rfind("command.", 0) == 0) continue;
    predictions.push_back(
        {prediction_of(channel.role), channel.unit, at_times_of(record, time, column->values)});
    require_finite(predictions.back().values, *column, file);
  }
  if (predictions.empty())
    throw Error{
        fmt::format("{}: predicts no measured channel, expected columns named {}", file, roles)};
  auto& channels = record.channels;
  channels.erase(std::remove_if(channels.begin(), channels.end(), is_prediction), channels.end());
  channels.insert(channels.end(), predictions.begin(), predictions.end());
}

}  // namespace

Case with_prediction(Case c, const std::filesystem::path& simulation) {
  const std::string file = simulation.string();
  const Table table = Table::load(simulation);
  const auto& time = time_of(table, file);
  const auto fit = std::find_if(c.records.begin(), c.records.end(),
                                [](const Record& record) { return record.use == Use::Fit; });
  if (fit == c.records.end()) throw Error{c.name + ": has no record to fit"};
  Record record = *fit;
  try {
    cut(record, time.front(), time.back());
  } catch (const Error& error) {
    throw Error{file + ": " + error.what()};
  }
  add_predictions(record, table, time, file);
  std::vector<Record> records{std::move(record)};
  for (auto& other : c.records)
    if (other.use == Use::Reference) records.push_back(std::move(other));
  c.records = std::move(records);
  // The record contains the predictions; the case may have terms to add to them, or a model that
  // they anchor.
  if (c.model.kind != ModelKind::Data && !c.model.table.has("anchor")) {
    c.model = {};
    c.source.file = c.source.file.without("model");
  }
  c.source.inputs.push_back(simulation);
  c.source.file.put("against", std::filesystem::proximate(simulation, c.source.folder).string());
  return c;
}

}  // namespace rths::diagnosis
