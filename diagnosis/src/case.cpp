// SPDX-License-Identifier: Apache-2.0
#include <rths/diagnosis/case.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>
#include <rths/recording/table.hpp>

#include "roles.hpp"

namespace rths::diagnosis {
namespace {

using recording::Table;

constexpr double kTimeTolerance = 0.02;  // of a step: what printed decimals can hold
constexpr double kRateTolerance = 1e-3;  // between the records of a case, of the time step

// "u_x [mm]": a column and its unit.
struct Source {
  std::string column;
  memmap::Unit unit{"1", 1, 0};
};

Source source_of(const Config& table, const std::string& key) {
  const std::string text = table.text(key);
  const auto open = text.rfind('[');
  if (open == std::string::npos || text.back() != ']')
    table.fail(key, fmt::format("'{}' names no unit, expected \"column [unit]\"", text));
  Source source;
  source.column = text.substr(0, text.find_last_not_of(' ', open == 0 ? 0 : open - 1) + 1);
  if (open == 0 || source.column.empty())
    table.fail(key, fmt::format("'{}' names no column, expected \"column [unit]\"", text));
  const std::string unit = text.substr(open + 1, text.size() - open - 2);
  source.unit = table.placed(key, [&] { return memmap::parse_unit(unit); });
  return source;
}

std::vector<double> in_si(const std::vector<double>& raw, const memmap::Unit& unit) {
  std::vector<double> values;
  values.reserve(raw.size());
  for (const double value : raw) values.push_back(unit.scale * value + unit.offset);
  return values;
}

void require_finite(const std::vector<double>& values, const std::string& role,
                    const std::string& file) {
  const auto bad = std::find_if_not(values.begin(), values.end(),
                                    [](double value) { return std::isfinite(value); });
  if (bad != values.end())
    throw Error{
        fmt::format("{}: {} has no finite value in row {}", file, role, bad - values.begin() + 1)};
}

// Time stamps must be equally spaced, as well as printed decimals can say it.
void read_time(const Config& channels, const Table& table, const std::string& file,
               Record& record) {
  if (!channels.has("time")) {
    record.time_step = 1 / channels.number_in("rate_Hz", 1e-6, 1e9);
    return;
  }
  const Source source = source_of(channels, "time");
  if (source.unit.si != "s")
    channels.fail("time", fmt::format("time is in {}, expected a unit of time", source.unit.si));
  const auto time =
      in_si(channels.placed("time", [&] { return table.column(source.column); }), source.unit);
  require_finite(time, "time", file);
  if (time.size() < 2) throw Error{fmt::format("{}: fewer than two samples", file)};
  record.start = time.front();
  record.time_step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double expected = record.start + static_cast<double>(i) * record.time_step;
    if (!(record.time_step > 0) ||
        std::abs(time[i] - expected) > kTimeTolerance * record.time_step + 1e-6)
      throw Error{
          fmt::format("{}: row {} is at {} s, expected {} s: samples are not equally spaced", file,
                      i + 1, time[i], expected)};
  }
}

// Tables in tables: displacement.long, predicted.force.long.
void read_channels(const Config& channels, const std::string& prefix, const Table& table,
                   const std::string& file, Record& record) {
  for (const auto& key : channels.keys()) {
    const std::string role = prefix + key;
    if (channels.is_table(key)) {
      read_channels(channels.table(key), role + ".", table, file, record);
      continue;
    }
    if (role == "time" || role == "rate_Hz") continue;
    const Source source = source_of(channels, key);
    if (const auto trouble = trouble_with(role, source.unit.si)) channels.fail(key, *trouble);
    Channel channel{role, source.unit.si, {}};
    channel.values =
        in_si(channels.placed(key, [&] { return table.column(source.column); }), source.unit);
    require_finite(channel.values, role, file);
    record.channels.push_back(std::move(channel));
  }
}

Use read_use(const Config& table) {
  const std::string use = table.text("use");
  if (use == "fit") return Use::Fit;
  if (use == "held_out") return Use::HeldOut;
  if (use == "reference") return Use::Reference;
  table.fail("use", fmt::format("use is '{}', expected fit, held_out or reference", use));
}

void read_quiet(const Config& table, Record& record) {
  if (!table.has("quiet_s")) return;
  const auto span = table.numbers("quiet_s");
  if (span.size() != 2 || !(span[0] < span[1])) table.fail("quiet_s", "quiet_s must be [from, to]");
  const auto sample = [&](double time) {
    const double i = std::round((time - record.start) / record.time_step);
    return static_cast<std::size_t>(std::clamp(i, 0.0, static_cast<double>(record.samples())));
  };
  record.quiet = {sample(span[0]), sample(span[1])};
  if (record.quiet->first >= record.quiet->second)
    table.fail("quiet_s", "quiet_s lies outside the recording");
}

Record read_record(const Config& table, const Config& channels) {
  Record record;
  const std::filesystem::path path = table.resolve(table.text("file"));
  record.name = path.filename().string();
  record.use = read_use(table);
  const Table columns = table.placed("file", [&] { return Table::load(path); });
  const Config own = channels.overlaid(table.table_or_empty("channels"));
  read_time(own, columns, path.string(), record);
  read_channels(own, "", columns, path.string(), record);
  if (record.channels.empty()) own.fail("time", "[channels] names no channel");
  for (const auto& channel : record.channels)
    if (channel.values.size() != record.samples())
      throw Error{fmt::format("{}: {} has {} samples, {} has {}", path.string(), channel.role,
                              channel.values.size(), record.channels[0].role, record.samples())};
  read_quiet(table, record);
  table.reject_unknown_keys();
  return record;
}

std::vector<FittedParameter> read_fitted(const Config& model) {
  std::vector<FittedParameter> fitted;
  for (const auto& name : model.texts("fitted", {})) fitted.push_back({name, std::nullopt});
  const Config bounds = model.table_or_empty("bounds");
  for (auto& parameter : fitted) {
    if (!bounds.has(parameter.name)) continue;
    const auto pair = bounds.numbers(parameter.name);
    if (pair.size() != 2 || !(pair[0] < pair[1]))
      bounds.fail(parameter.name, "bounds must be [low, high]");
    parameter.bounds = {pair[0], pair[1]};
  }
  bounds.reject_unknown_keys();
  return fitted;
}

Model read_model(const Config& table) {
  Model model{table.text("kind", "data"), table, read_fitted(table)};
  if (!is_model_kind(model.kind))
    table.fail("kind", fmt::format("there is no model of kind '{}', expected {}", model.kind,
                                   model_kinds()));
  return model;
}

void check(const Case& c, const Config& file) {
  const auto is_fit = [](const Record& record) { return record.use == Use::Fit; };
  const auto fit = std::find_if(c.records.begin(), c.records.end(), is_fit);
  if (fit == c.records.end()) file.fail("record", "no [[record]] has use = \"fit\"");
  for (const auto& record : c.records)
    if (std::abs(record.time_step / fit->time_step - 1) > kRateTolerance)
      file.fail("record", fmt::format("{} is sampled every {} s, {} every {} s: expected one rate",
                                      record.name, record.time_step, fit->name, fit->time_step));
}

}  // namespace

std::size_t Record::samples() const { return channels.empty() ? 0 : channels[0].values.size(); }

const Channel* Record::find(const std::string& role) const {
  for (const auto& channel : channels)
    if (channel.role == role) return &channel;
  return nullptr;
}

Case load_case(const std::filesystem::path& folder) {
  const Config file = Config::load(folder / "case.toml");
  const std::int64_t format = file.integer("format");
  if (format != kCaseFormat)
    file.fail("format", fmt::format("format is {}, this program reads {}", format, kCaseFormat));
  Case result;
  result.name = file.text("name", folder.filename().string());
  result.folder = folder;
  const Config channels = file.table("channels");
  for (const auto& record : file.tables("record"))
    result.records.push_back(read_record(record, channels));
  result.model = read_model(file.table_or_empty("model"));
  const Config noise = file.table_or_empty("noise");
  for (const auto& role : noise.keys()) {
    const Source source = source_of(noise, role);
    char* end = nullptr;
    const double value = std::strtod(source.column.c_str(), &end);
    if (*end != '\0' || !(value > 0))
      noise.fail(role, fmt::format("'{}' is no standard deviation, expected \"2e-5 [m]\"",
                                   noise.text(role)));
    result.noise.emplace_back(role, value * source.unit.scale);
  }
  file.reject_unknown_keys();
  check(result, file);
  return result;
}

}  // namespace rths::diagnosis
