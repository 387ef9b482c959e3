// SPDX-License-Identifier: Apache-2.0
#include "case_history.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>

#include <fmt/format.h>

namespace rths::diagnosis {
namespace {

bool is_section(const Record& record, const Config& table) {
  return table.has("span_s") && !table.has("channels") && record.use != Use::Reference;
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
