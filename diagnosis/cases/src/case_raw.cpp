// SPDX-License-Identifier: Apache-2.0
#include "case_raw.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>

#include "roles.hpp"

namespace rths::diagnosis {
namespace {

void read_time(const Config& channels, Files& files, Raw& raw) {
  if (!channels.has("time")) return;
  if (channels.text("time") == kNoTime) {
    if (channels.has("rate_Hz"))
      channels.fail("rate_Hz",
                    "rate_Hz stands beside time = \"none\", expected only one of the two");
    raw.has_time = false;
    return;
  }
  const Source source = source_of(channels, "time");
  if (source.unit.si != "s")
    channels.fail("time", fmt::format("time is in {}, expected a unit of time", source.unit.si));
  if (source.number) channels.fail("time", "time is a number, expected a column or rate_Hz");
  if (channels.has("rate_Hz"))
    channels.fail("rate_Hz", "rate_Hz stands beside time, expected only one of the two");
  raw.time = files.column(channels, source, raw.file, raw.time_trouble);
}

// Reads nested tables: displacement.long, predicted.force.long.
void read_channels(const Config& table, const std::string& prefix, Files& files, Raw& raw) {
  for (const auto& key : table.keys()) {
    const std::string role = prefix + key;
    if (table.is_table(key)) {
      read_channels(table.table(key), role + ".", files, raw);
      continue;
    }
    if (role == "time" || role == "rate_Hz" || role == "held") continue;
    const Source source = source_of(table, key);
    if (const auto trouble = trouble_with(role, source.unit.si)) table.fail(key, *trouble);
    Channel channel{role, source.unit.si, {}};
    Trouble trouble;
    if (source.number)
      raw.constants.emplace_back(raw.channels.size(), *source.number);
    else
      channel.values = files.column(table, source, raw.file, trouble);
    raw.channels.push_back(std::move(channel));
    raw.troubles.push_back(std::move(trouble));
  }
}

// Extends constants to the length of the columns, which must all be equal.
void complete(Raw& raw, const Config& channels) {
  if (raw.channels.empty()) channels.fail("time", "[channels] names no channel");
  std::size_t rows = raw.time.size();
  for (const auto& channel : raw.channels)
    if (rows == 0) rows = channel.values.size();
  if (rows == 0) channels.fail("time", "[channels] names no column, only numbers");
  for (const auto& [index, value] : raw.constants) raw.channels[index].values.assign(rows, value);
  for (const auto& channel : raw.channels)
    if (channel.values.size() != rows)
      throw Error{fmt::format("{}: {} has {} samples, others have {}", raw.file, channel.role,
                              channel.values.size(), rows)};
}

// A controller holds its output until the next sample. At a sample, the channel becomes the mean of
// the held values before and after it.
void hold(Raw& raw, const Config& channels) {
  for (const auto& role : channels.texts("held", {})) {
    const auto held = std::find_if(raw.channels.begin(), raw.channels.end(),
                                   [&](const Channel& channel) { return channel.role == role; });
    if (held == raw.channels.end())
      channels.fail("held", fmt::format("there is no channel '{}'", role));
    double before = held->values[0];
    for (double& value : held->values) {
      const double now = value;
      value = 0.5 * (before + now);
      before = now;
    }
  }
}

template <class T>
void cut(std::vector<T>& values, std::ptrdiff_t from, std::ptrdiff_t to) {
  values = {values.begin() + from, values.begin() + to};
}

// The resampled samples before and behind each gap in the old ones.
std::vector<std::pair<std::size_t, std::size_t>> gaps_of(const std::vector<double>& time,
                                                         double rate, std::size_t count) {
  const double shortest = (1 + 1e-6) * double{kBridged} * median_step(time);
  std::vector<std::pair<std::size_t, std::size_t>> gaps;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] - time[i - 1] <= shortest) continue;
    const auto last = static_cast<std::size_t>((time[i - 1] - time.front()) * rate);
    const auto next = static_cast<std::size_t>(std::ceil((time[i] - time.front()) * rate));
    gaps.emplace_back(last, std::min(next, count - 1));
  }
  return gaps;
}

}  // namespace

Raw read_raw(const Config& channels, Files& files, const std::string& file) {
  Raw raw;
  raw.file = file;
  read_time(channels, files, raw);
  read_channels(channels, "", files, raw);
  complete(raw, channels);
  hold(raw, channels);
  if (!raw.time.empty()) return raw;
  if (!raw.has_time) {
    raw.time.resize(raw.channels[0].values.size());
    std::iota(raw.time.begin(), raw.time.end(), 1.0);
    return raw;
  }
  const double rate = channels.number_in("rate_Hz", kLowestRate, kHighestRate);
  for (std::size_t i = 0; i < raw.channels[0].values.size(); ++i)
    raw.time.push_back(static_cast<double>(i) / rate);
  return raw;
}

void cut_out(Raw& raw, double from, double to) {
  const auto inside = [&](double time) {
    return time >= from - kPrintedTime && time <= to + kPrintedTime;
  };
  const auto first = std::find_if(raw.time.begin(), raw.time.end(), inside);
  const auto last = std::find_if(raw.time.rbegin(), raw.time.rend(), inside).base();
  if (last - first < 2)
    throw Error{
        fmt::format("{0} to {1}{4} contains fewer than two samples; the recording covers {2} to "
                    "{3}{4}",
                    from, to, raw.time.front(), raw.time.back(), raw.has_time ? " s" : "")};
  const auto begin = first - raw.time.begin(), end = last - raw.time.begin();
  for (auto& channel : raw.channels) cut(channel.values, begin, end);
  cut(raw.time, begin, end);
  raw.time_trouble.row -= begin;
  for (auto& trouble : raw.troubles) trouble.row -= begin;
}

void require_increase(const Raw& raw, std::size_t row) {
  if (!(raw.time[row] > raw.time[row - 1]))
    throw Error{fmt::format("{}: row {} is at {} s, after {} s: time must increase", raw.file,
                            row + 1, raw.time[row], raw.time[row - 1])};
}

double median_step(const std::vector<double>& time) { return maths::median(maths::steps_of(time)); }

void resample(Raw& raw, double rate) {
  const auto old = raw.time;
  for (std::size_t i = 1; i < old.size(); ++i) require_increase(raw, i);
  const auto count = static_cast<std::size_t>((old.back() - old.front()) * rate + 1e-9) + 1;
  raw.gaps = gaps_of(old, rate, count);
  raw.time.resize(count);
  std::vector<std::pair<std::size_t, double>> weights(count);  // sample before, share of the next
  for (std::size_t k = 0, i = 0; k < count; ++k) {
    const double t = old.front() + static_cast<double>(k) / rate;
    while (i + 2 < old.size() && old[i + 1] <= t) ++i;
    raw.time[k] = t;
    weights[k] = {i, (t - old[i]) / (old[i + 1] - old[i])};
  }
  for (auto& channel : raw.channels) {
    std::vector<double> values;
    values.reserve(count);
    for (const auto& [i, share] : weights)
      values.push_back((1 - share) * channel.values[i] + share * channel.values[i + 1]);
    channel.values = std::move(values);
  }
}

}  // namespace rths::diagnosis
