// SPDX-License-Identifier: Apache-2.0
#include "case_record.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>

#include "case_raw.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kTimeTolerance = 0.02;  // of a step

// @param trouble  the first cell of the file without a finite number
void require_finite(const std::vector<double>& values, const Trouble& trouble,
                    const std::string& name, const std::string& file) {
  const auto is_bad = [](double value) { return !std::isfinite(value); };
  const auto bad = std::find_if(values.begin(), values.end(), is_bad);
  if (bad == values.end()) return;
  if (!trouble.text.empty() && bad - values.begin() == trouble.row)
    throw Error{trouble.text + ": fill the gap, or exclude it by span_s"};
  const auto count = std::count_if(bad, values.end(), is_bad);
  throw Error{fmt::format(
      "{}: {} is NaN or infinite in sample {}{}: fill the gap, or exclude it by span_s", file, name,
      bad - values.begin() + 1, count == 1 ? "" : fmt::format(" and {} others", count - 1))};
}

void require_finite(const Raw& raw) {
  require_finite(raw.time, raw.time_trouble, "time", raw.file);
  for (std::size_t i = 0; i < raw.channels.size(); ++i)
    require_finite(raw.channels[i].values, raw.troubles[i], raw.channels[i].role, raw.file);
}

// The first step that differs from the usual one; the expected time of a row, if steps drift.
[[noreturn]] void fail_spacing(const Raw& raw, std::size_t row, double expected) {
  const auto& time = raw.time;
  const double usual = median_step(time);
  std::string found = fmt::format("{:.13g} s, expected {:.13g} s", time[row], expected);
  for (std::size_t i = 1; i < time.size(); ++i) {
    const double step = time[i] - time[i - 1];
    if (std::abs(step - usual) <= kTimeTolerance * usual + kPrintedTime) continue;
    row = i;
    found = fmt::format("{:.13g} s, {:.6g} s after row {} at {:.13g} s, expected {:.6g} s", time[i],
                        step, i, time[i - 1], usual);
    break;
  }
  throw Error{
      fmt::format("{}: row {} is at {}: samples are not equally spaced; give one record to "
                  "each section (span_s), or resample_Hz, or rate_Hz instead of time if "
                  "only the time stamps are wrong",
                  raw.file, row + 1, found)};
}

void require_two_samples(const Raw& raw) {
  if (raw.time.size() < 2)
    throw Error{
        fmt::format("{}: found {} samples, expected at least two", raw.file, raw.time.size())};
}

// Time stamps must be equally spaced, within the resolution of printed decimals.
void take_spacing(const Raw& raw, Record& record) {
  const auto& time = raw.time;
  record.start = time.front();
  record.time_step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  for (std::size_t i = 1; i < time.size(); ++i) require_increase(raw, i);
  if (!(record.time_step >= 1 / kHighestRate && record.time_step <= 1 / kLowestRate))
    throw Error{fmt::format("{}: samples are {:g} s apart, expected {:g} to {:g} s", raw.file,
                            record.time_step, 1 / kHighestRate, 1 / kLowestRate)};
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double expected = record.start + static_cast<double>(i) * record.time_step;
    if (std::abs(time[i] - expected) > kTimeTolerance * record.time_step + kPrintedTime)
      fail_spacing(raw, i, expected);
  }
}

std::vector<double> span_of(const Config& table, const std::string& key) {
  auto span = table.numbers(key);
  if (span.size() != 2 || !(span[0] < span[1]))
    table.fail(
        key, fmt::format("{} is [{}], expected [from, to], from < to", key, fmt::join(span, ", ")));
  return span;
}

void resample(const Config& table, Raw& raw) {
  constexpr double kMostResampled = 20'000'000;  // samples: 16 channels fit into 3 GB
  const double rate = table.number_in("resample_Hz", kLowestRate, kHighestRate);
  const double count = (raw.time.back() - raw.time.front()) * rate;
  if (!(count >= 1 && count <= kMostResampled))
    table.fail("resample_Hz",
               fmt::format("resampling {:.6g} s at {:g} Hz makes {:.3g} samples, "
                           "expected 1 to {:.0f}",
                           raw.time.back() - raw.time.front(), rate, count, kMostResampled));
  resample(raw, rate);
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
  const double first = record.start;
  const double last = first + static_cast<double>(record.samples() - 1) * record.time_step;
  const double slack = record.time_step + kPrintedTime;
  if (span[0] < first - slack || span[1] > last + slack)
    table.fail("quiet_s", fmt::format("quiet_s is {} to {} s, expected times within {:.13g} to "
                                      "{:.13g} s, which the record covers",
                                      span[0], span[1], first, last));
  record.quiet = {sample(span[0]), sample(span[1])};
  if (record.quiet->first + 2 > record.quiet->second)
    table.fail("quiet_s", fmt::format("quiet_s is {} to {} s, expected at least two samples of "
                                      "{:g} s",
                                      span[0], span[1], record.time_step));
}

void read_settle(const Config& table, Record& record) {
  const double length = static_cast<double>(record.samples()) * record.time_step;
  record.settle = table.number_in("settle_s", 0, length, 0.0);
}

// Rows without time have no seconds, and times no rows.
void refuse_times(const Config& table, bool has_time) {
  if (has_time && table.has("span_rows"))
    table.fail("span_rows", "the record has a time, expected span_s");
  for (const char* key : {"span_s", "quiet_s", "settle_s", "resample_Hz"})
    if (!has_time && table.has(key))
      table.fail(key, fmt::format("the record has no time, expected no {}: span_rows = [from, to] "
                                  "selects rows",
                                  key));
}

// A record's own time replaces the rate of the case, and its own rate the time.
Config channels_of(const Config& table, const Config& channels) {
  const Config own = table.table_or_empty("channels");
  if (own.has("time") && !own.has("rate_Hz")) return channels.without("rate_Hz").overlaid(own);
  if (own.has("rate_Hz") && !own.has("time")) return channels.without("time").overlaid(own);
  return channels.overlaid(own);
}

// At the key of a role, which may be in a nested table: displacement.long.
[[noreturn]] void fail_at(const Config& channels, const std::string& role,
                          const std::string& what) {
  const auto dot = role.find('.');
  if (channels.has(role) || dot == std::string::npos) channels.fail(role, what);
  fail_at(channels.table(role.substr(0, dot)), role.substr(dot + 1), what);
}

// Other axes may be recorded beside these.
void require_axis(const Raw& raw, const Config& channels) {
  for (const std::string family : {"command.", "displacement.", "force."}) {
    const Channel* other = nullptr;
    bool is_known = false;
    for (const auto& channel : raw.channels) {
      if (!channel.role.starts_with(family)) continue;
      const std::string axis = channel.role.substr(family.size());
      is_known = is_known || horizontal_axis_named(axis) || axis == "vertical";
      other = &channel;
    }
    if (other != nullptr && !is_known)
      fail_at(channels, other->role,
              fmt::format("the model has no axis of '{}', expected {}long or {}lat", other->role,
                          family, family));
  }
}

void refuse_far_motion(const Raw& raw, const Config& channels) {
  constexpr double kReach = 10;  // [m]: no machine moves further
  for (const auto& channel : raw.channels) {
    const bool is_position =
        channel.role.starts_with("displacement.") || channel.role.starts_with("command.");
    if (!is_position || channel.unit != "m") continue;
    const double most = maths::largest_magnitude(channel.values);
    if (most > kReach)
      fail_at(channels, channel.role,
              fmt::format("{} reaches {:.3g} m in {}, expected at most {} m: check its unit",
                          channel.role, most, raw.file, kReach));
  }
}

}  // namespace

std::string name_in(const Config& table, const std::string& usual) {
  std::string name = table.text("name", usual);
  if (table.has("name") && name.empty())
    table.fail("name", "name is empty, expected at least one character");
  if (printable(name) != name)
    table.fail("name",
               fmt::format("name is '{}', expected a name without control characters", name));
  return name;
}

Record read_record(const Config& table, const Config& channels, Files& files, bool is_machine) {
  const Config own = channels_of(table, channels);
  const auto path = table.resolve(table.text("file"));
  const std::string file = path.string();
  table.placed("file", [&] { static_cast<void>(files.at(path)); });
  Raw raw = read_raw(own, files, file);
  Record record;
  record.name = name_in(table, std::filesystem::path{file}.filename().string());
  record.use = read_use(table);
  record.has_time = raw.has_time;
  refuse_times(table, raw.has_time);
  const char* const section = raw.has_time ? "span_s" : "span_rows";
  if (table.has(section)) {
    const auto span = span_of(table, section);
    table.placed(section, [&] { cut_out(raw, span[0], span[1]); });
  }
  require_finite(raw);
  if (is_machine) {
    require_axis(raw, own);
    refuse_far_motion(raw, own);
  }
  require_two_samples(raw);
  if (table.has("resample_Hz")) resample(table, raw);
  take_spacing(raw, record);
  record.channels = std::move(raw.channels);
  record.gaps = std::move(raw.gaps);
  read_quiet(table, record);
  read_settle(table, record);
  table.reject_unknown_keys();
  return record;
}

}  // namespace rths::diagnosis
