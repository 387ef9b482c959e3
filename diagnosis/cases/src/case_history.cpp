// SPDX-License-Identifier: Apache-2.0
#include "case_history.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>
#include <string_view>

#include <fmt/format.h>

#include <rths/cases/rest.hpp>

namespace rths::diagnosis {
namespace {

// Samples of a channel, from the first to the one behind the last.
struct Section {
  const Record* record;
  const Channel* channel;
  std::size_t from, to;

  [[nodiscard]] std::size_t size() const { return to - from; }
  [[nodiscard]] double time_at(std::size_t sample) const {
    return record->start + static_cast<double>(sample) * record->time_step;
  }
  [[nodiscard]] auto begin() const {
    return channel->values.begin() + static_cast<std::ptrdiff_t>(from);
  }
  [[nodiscard]] auto end() const {
    return channel->values.begin() + static_cast<std::ptrdiff_t>(to);
  }
};

double deviation_of(const Section& section) {
  const auto count = static_cast<double>(section.size());
  double sum = 0, squares = 0;
  for (const double value : section) sum += value;
  for (const double value : section) squares += std::pow(value - sum / count, 2);
  return std::sqrt(squares / count);
}

// What drives a test, and what a model predicts. An acceleration may be nothing but noise.
bool shows_motion(const Channel& channel) {
  constexpr std::string_view kFamilies[] = {"command", "displacement", "input", "force", "output"};
  return std::find(std::begin(kFamilies), std::end(kFamilies), family_of(channel.role)) !=
         std::end(kFamilies);
}

// The largest standard deviation in the moving records. One axis may be at rest while another
// moves, so all channels of a family and unit count.
double deviation_in_motion(const Channel& channel, const std::vector<Record>& records) {
  double largest = 0;
  for (const auto& record : records) {
    if (record.use == Use::Reference) continue;
    for (const auto& other : record.channels)
      if (family_of(other.role) == family_of(channel.role) && other.unit == channel.unit)
        largest = std::max(largest, deviation_of({&record, &other, 0, record.samples()}));
  }
  return largest;
}

std::vector<Section> parts_of(const Section& whole, std::size_t count) {
  const auto edge = [&](std::size_t part) { return whole.from + part * whole.size() / count; };
  std::vector<Section> parts;
  for (std::size_t i = 0; i < count; ++i)
    parts.push_back({whole.record, whole.channel, edge(i), edge(i + 1)});
  return parts;
}

// Noise is as large in each part. A coarse channel may be constant in most of them.
std::string unevenness_of(const Section& whole, double in_motion) {
  constexpr std::size_t kParts = 5, kFewestInPart = 10, kStepsOfNoise = 4;
  constexpr double kMostRatio = 4;
  constexpr double kInsignificant = 0.005;  // of the deviation in motion
  if (whole.size() < kParts * kFewestInPart) return "";
  auto parts = parts_of(whole, kParts);
  std::sort(parts.begin(), parts.end(), [](const Section& one, const Section& other) {
    return deviation_of(one) < deviation_of(other);
  });
  const Section& loudest = parts.back();
  const double largest = deviation_of(loudest), usual = deviation_of(parts[kParts / 2]);
  if (largest <= std::max(kMostRatio * usual, kInsignificant * in_motion)) return "";
  if (std::set<double>{loudest.begin(), loudest.end()}.size() <= kStepsOfNoise) return "";
  const Channel& channel = *whole.channel;
  return fmt::format(
      "{} is not at rest in all of quiet_s of {}: its standard deviation is {:.3g} {} "
      "from {:.13g} to {:.13g} s, expected at most {} times the usual {:.3g} {}",
      channel.role, whole.record->name, largest, channel.unit, loudest.time_at(loudest.from),
      loudest.time_at(loudest.to), kMostRatio, usual, channel.unit);
}

std::string motion_in(const Section& section, const std::vector<Record>& records) {
  constexpr std::size_t kFewest = 10;  // samples that have a deviation
  constexpr double kMostShare = 0.5;   // of the deviation in motion: sensors may be noisy
  const double in_motion = deviation_in_motion(*section.channel, records);
  if (section.size() < kFewest || !(in_motion > 0)) return "";
  const double found = deviation_of(section);
  const std::string& unit = section.channel->unit;
  if (found >= kMostShare * in_motion)
    return fmt::format(
        "{} moves in quiet_s of {}: its standard deviation is {:.3g} {}, expected "
        "below {:.3g} {}, half of that in motion",
        section.channel->role, section.record->name, found, unit, kMostShare * in_motion, unit);
  return unevenness_of(section, in_motion);
}

// Distance from the smallest to the largest value of a channel in some samples; 0: not recorded.
double range_of(const Record& record, const std::string& role, std::size_t from, std::size_t to) {
  const Channel* channel = record.find(role);
  if (channel == nullptr || from >= to) return 0;
  const Section section{&record, channel, from, to};
  const auto [least, most] = std::minmax_element(section.begin(), section.end());
  return *most - *least;
}

void refuse_motion_of_reference(const Record& reference, const Config& table,
                                const std::vector<Record>& records) {
  constexpr double kMostShare = 0.1;  // of the motion of the test
  for (const auto& channel : reference.channels) {
    if (!channel.role.starts_with("displacement.")) continue;
    double tested = 0;
    for (const auto& record : records)
      if (record.use != Use::Reference)
        tested = std::max(tested, range_of(record, channel.role, 0, record.samples()));
    const auto [from, to] = *reference.quiet;
    const double range = range_of(reference, channel.role, from, to);
    if (tested > 0 && range > kMostShare * tested)
      table.fail(table.has("quiet_s") ? "quiet_s" : "use",
                 fmt::format("{} moves by {:.3g} m in {}, expected no motion: the record is used "
                             "to measure the noise; quiet_s = [from, to] selects a section at rest",
                             channel.role, range, reference.name));
  }
}

bool is_section(const Record& record, const Config& table) {
  return (table.has("span_s") || table.has("span_rows")) && !table.has("channels") &&
         record.use != Use::Reference;
}

bool have_same_channels(const Record& one, const Record& other) {
  return std::equal(one.channels.begin(), one.channels.end(), other.channels.begin(),
                    other.channels.end(),
                    [](const Channel& a, const Channel& b) { return a.role == b.role; });
}

// Number of samples of a section before another one begins; 0: they do not join.
std::size_t samples_before(const Record& section, const Record& later) {
  const double step = later.time_step;
  if (std::abs(section.time_step - step) > 1e-6 * step || !have_same_channels(section, later))
    return 0;
  const double count = std::round((later.start - section.start) / step);
  return count >= 1 && count <= static_cast<double>(section.samples())
             ? static_cast<std::size_t>(count)
             : 0;
}

void prepend(const Record& past, std::size_t count, Record& record) {
  for (std::size_t i = 0; i < record.channels.size(); ++i) {
    const auto begin = past.channels[i].values.begin();
    auto& values = record.channels[i].values;
    values.insert(values.begin(), begin, begin + static_cast<std::ptrdiff_t>(count));
  }
  for (auto& [last, next] : record.gaps) last += count, next += count;
  for (const auto& gap : past.gaps)
    if (gap.second < count) record.gaps.push_back(gap);
  if (record.quiet) record.quiet = {record.quiet->first + count, record.quiet->second + count};
  const double length = static_cast<double>(count) * record.time_step;
  record.start -= length;
  record.settle += length;
}

bool have_same_file(const Config& one, const Config& other) {
  const auto file = [](const Config& table) { return table.resolve(table.text("file")); };
  std::error_code problem;
  return std::filesystem::equivalent(file(one), file(other), problem);
}

bool have_same_source(const Config& one, const Config& other) {
  const auto channels = [](const Config& table) {
    return table.table_or_empty("channels").to_toml();
  };
  return have_same_file(one, other) && channels(one) == channels(other);
}

bool have_same_values(const Record& one, const Record& other) {
  return have_same_channels(one, other) &&
         std::equal(one.channels.begin(), one.channels.end(), other.channels.begin(),
                    [](const Channel& a, const Channel& b) { return a.values == b.values; });
}

const char* words_of(Use use) { return use == Use::Fit ? "fit" : "hold out"; }

// Why two records may not have the same samples.
const char* reason_against(const Record& one, const Record& other) {
  return one.use == other.use ? "samples that are compared twice count too much"
                              : "data that were fitted prove nothing";
}

double end_of(const Record& record) {
  return record.start + static_cast<double>(record.samples() - 1) * record.time_step;
}

// A record and its table in the case.
struct RecordWithTable {
  const Record& record;
  const Config& table;
};

void refuse_copy(const RecordWithTable& earlier, const RecordWithTable& later) {
  if (have_same_file(earlier.table, later.table) || !have_same_values(earlier.record, later.record))
    return;
  later.table.fail("file", fmt::format("{} has the values of {}, a record to {}, in each channel, "
                                       "expected another test: {}",
                                       later.table.text("file"), earlier.record.name,
                                       words_of(earlier.record.use),
                                       reason_against(earlier.record, later.record)));
}

void refuse_overlap(const RecordWithTable& earlier, const RecordWithTable& later) {
  if (!have_same_source(earlier.table, later.table)) return;
  const double from = std::max(earlier.record.start, later.record.start);
  const double to = std::min(end_of(earlier.record), end_of(later.record));
  // Sections that adjoin share a sample.
  if (to - from <= 1.5 * std::max(earlier.record.time_step, later.record.time_step)) return;
  later.table.fail("file", fmt::format("{} is also a record to {}, from {:.13g} to {:.13g} s, "
                                       "expected sections that do not overlap (span_s) or "
                                       "another file: {}",
                                       later.table.text("file"), words_of(earlier.record.use), from,
                                       to, reason_against(earlier.record, later.record)));
}

}  // namespace

std::string motion_at_rest(const Record& record, std::pair<std::size_t, std::size_t> samples,
                           const std::vector<Record>& records) {
  for (const auto& channel : record.channels) {
    if (!shows_motion(channel)) continue;
    if (std::string motion = motion_in({&record, &channel, samples.first, samples.second}, records);
        !motion.empty())
      return motion;
  }
  return "";
}

void refuse_motion_at_rest(const std::vector<Record>& records, const std::vector<Config>& tables) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Record& record = records[i];
    if (!record.quiet) continue;
    if (record.use == Use::Reference) {
      refuse_motion_of_reference(record, tables[i], records);
      continue;
    }
    if (const std::string motion = motion_at_rest(record, *record.quiet, records); !motion.empty())
      tables[i].fail("quiet_s", motion);
  }
}

void refuse_overlap(const std::vector<Record>& records, const std::vector<Config>& tables) {
  for (std::size_t i = 0; i < records.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const RecordWithTable earlier{records[k], tables[k]}, later{records[i], tables[i]};
      if (records[k].use == Use::Reference || records[i].use == Use::Reference) continue;
      refuse_copy(earlier, later);
      refuse_overlap(earlier, later);
    }
}

void join_sections(std::vector<Record>& records, const std::vector<Config>& tables) {
  std::vector<std::size_t> order(records.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return records[a].start < records[b].start;
  });
  for (auto later = order.begin(); later != order.end(); ++later) {
    if (!is_section(records[*later], tables[*later])) continue;
    // The section that began last has the longest past.
    for (auto earlier = later; earlier != order.begin();) {
      const Config& table = tables[*--earlier];
      if (!is_section(records[*earlier], table) ||
          table.text("file") != tables[*later].text("file"))
        continue;
      const std::size_t count = samples_before(records[*earlier], records[*later]);
      if (count == 0) continue;
      prepend(records[*earlier], count, records[*later]);
      break;
    }
  }
}

}  // namespace rths::diagnosis
