// SPDX-License-Identifier: Apache-2.0
#include "case_history.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

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

}  // namespace

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
