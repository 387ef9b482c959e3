// SPDX-License-Identifier: Apache-2.0
#include "case_rest.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <string_view>

#include <fmt/format.h>

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
void refuse_uneven(const Section& whole, double in_motion, const Config& table) {
  constexpr std::size_t kParts = 5, kFewestInPart = 10, kStepsOfNoise = 4;
  constexpr double kMostRatio = 4;
  constexpr double kInsignificant = 0.005;  // of the deviation in motion
  if (whole.size() < kParts * kFewestInPart) return;
  auto parts = parts_of(whole, kParts);
  std::sort(parts.begin(), parts.end(), [](const Section& one, const Section& other) {
    return deviation_of(one) < deviation_of(other);
  });
  const Section& loudest = parts.back();
  const double largest = deviation_of(loudest), usual = deviation_of(parts[kParts / 2]);
  if (largest <= std::max(kMostRatio * usual, kInsignificant * in_motion)) return;
  if (std::set<double>{loudest.begin(), loudest.end()}.size() <= kStepsOfNoise) return;
  const Channel& channel = *whole.channel;
  table.fail(
      "quiet_s",
      fmt::format("{} is not at rest in all of quiet_s of {}: its standard deviation is {:.3g} {} "
                  "from {:.13g} to {:.13g} s, expected at most {} times the usual {:.3g} {}",
                  channel.role, whole.record->name, largest, channel.unit,
                  loudest.time_at(loudest.from), loudest.time_at(loudest.to), kMostRatio, usual,
                  channel.unit));
}

void refuse_motion_in(const Section& section, const std::vector<Record>& records,
                      const Config& table) {
  constexpr std::size_t kFewest = 10;  // samples that have a deviation
  constexpr double kMostShare = 0.5;   // of the deviation in motion: sensors may be noisy
  const double in_motion = deviation_in_motion(*section.channel, records);
  if (section.size() < kFewest || !(in_motion > 0)) return;
  const double found = deviation_of(section);
  const std::string& unit = section.channel->unit;
  if (found >= kMostShare * in_motion)
    table.fail(
        "quiet_s",
        fmt::format("{} moves in quiet_s of {}: its standard deviation is {:.3g} {}, expected "
                    "below {:.3g} {}, half of that in motion",
                    section.channel->role, section.record->name, found, unit,
                    kMostShare * in_motion, unit));
  refuse_uneven(section, in_motion, table);
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

}  // namespace

void refuse_motion_at_rest(const std::vector<Record>& records, const std::vector<Config>& tables) {
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Record& record = records[i];
    if (!record.quiet) continue;
    if (record.use == Use::Reference) {
      refuse_motion_of_reference(record, tables[i], records);
      continue;
    }
    for (const auto& channel : record.channels)
      if (shows_motion(channel))
        refuse_motion_in({&record, &channel, record.quiet->first, record.quiet->second}, records,
                         tables[i]);
  }
}

}  // namespace rths::diagnosis
