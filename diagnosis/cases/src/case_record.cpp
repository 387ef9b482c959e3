// SPDX-License-Identifier: Apache-2.0
#include "case_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "case_raw.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kTimeTolerance = 0.02;  // of a step

void require_finite(const std::vector<double>& values, const std::string& name,
                    const std::string& file) {
  const auto is_bad = [](double value) { return !std::isfinite(value); };
  const auto bad = std::find_if(values.begin(), values.end(), is_bad);
  if (bad == values.end()) return;
  const auto count = std::count_if(bad, values.end(), is_bad);
  throw Error{fmt::format(
      "{}: {} is NaN or infinite in sample {}{}: fill the gap, or exclude it by span_s", file, name,
      bad - values.begin() + 1, count == 1 ? "" : fmt::format(" and {} others", count - 1))};
}

void require_finite(const Raw& raw) {
  require_finite(raw.time, "time", raw.file);
  for (const auto& channel : raw.channels) require_finite(channel.values, channel.role, raw.file);
}

// Time stamps must be equally spaced, within the resolution of printed decimals.
void take_spacing(const Raw& raw, Record& record) {
  const auto& time = raw.time;
  if (time.size() < 2) throw Error{fmt::format("{}: fewer than two samples", raw.file)};
  record.start = time.front();
  record.time_step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double expected = record.start + static_cast<double>(i) * record.time_step;
    if (!(record.time_step > 0) ||
        std::abs(time[i] - expected) > kTimeTolerance * record.time_step + kPrintedTime)
      throw Error{fmt::format(
          "{}: row {} is at {} s, expected {} s: samples are not equally spaced; give rate_Hz "
          "instead of time if only the time stamps are wrong, or resample_Hz",
          raw.file, i + 1, time[i], expected)};
  }
}

std::vector<double> span_of(const Config& table, const std::string& key) {
  auto span = table.numbers(key);
  if (span.size() != 2 || !(span[0] < span[1]))
    table.fail(key, fmt::format("{} must be [from, to]", key));
  return span;
}

Use read_use(const Config& table) {
  const std::string use = table.text("use");
  if (use == "fit") return Use::Fit;
  if (use == "held_out") return Use::HeldOut;
  if (use == "reference") return Use::Reference;
  table.fail("use", fmt::format("use is '{}', expected fit, held_out or reference", use));
}

void read_quiet(const Config& table, Record& record) {
  if (!table.has("quiet_s")) {
    if (record.use == Use::Reference) record.quiet = {0, record.samples()};
    return;
  }
  const auto span = span_of(table, "quiet_s");
  const auto sample = [&](double time) {
    const double i = std::round((time - record.start) / record.time_step);
    return static_cast<std::size_t>(std::clamp(i, 0.0, static_cast<double>(record.samples())));
  };
  record.quiet = {sample(span[0]), sample(span[1])};
  if (record.quiet->first >= record.quiet->second)
    table.fail("quiet_s", "quiet_s lies outside the recording");
}

void read_settle(const Config& table, Record& record) {
  const double length = static_cast<double>(record.samples()) * record.time_step;
  record.settle = table.number_in("settle_s", 0, length, 0.0);
}

}  // namespace

Record read_record(const Config& table, const Config& channels, Files& files) {
  const Config own = channels.overlaid(table.table_or_empty("channels"));
  const std::string file = table.placed("file", [&] {
    const auto path = table.resolve(table.text("file"));
    static_cast<void>(files.at(path));
    return path.string();
  });
  Raw raw = read_raw(own, files, file);
  Record record;
  record.name = table.text("name", std::filesystem::path{file}.filename().string());
  record.use = read_use(table);
  if (table.has("span_s")) {
    const auto span = span_of(table, "span_s");
    table.placed("span_s", [&] { cut_out(raw, span[0], span[1]); });
  }
  require_finite(raw);
  if (table.has("resample_Hz"))
    resample(raw, table.number_in("resample_Hz", kLowestRate, kHighestRate));
  take_spacing(raw, record);
  record.channels = std::move(raw.channels);
  read_quiet(table, record);
  read_settle(table, record);
  table.reject_unknown_keys();
  return record;
}

}  // namespace rths::diagnosis
