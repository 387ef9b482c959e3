// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include "analysis.hpp"

namespace rths::report {
namespace {

constexpr std::size_t kMostChanges = 50;  // of a word: more is a stream of data

std::vector<OperatorChange> changes_of(const Reader& run, const std::string& name) {
  std::vector<OperatorChange> changes;
  const auto values = run.signal(name);
  for (std::size_t i = 1; i < values.size() && changes.size() <= kMostChanges; ++i)
    if (values[i] != values[i - 1] && !std::isnan(values[i]) && !std::isnan(values[i - 1]))
      changes.push_back({run.time()[i], name, run.unit(name), values[i - 1], values[i]});
  return changes;
}

}  // namespace

std::vector<OperatorChange> operator_changes(const Reader& run) {
  std::set<std::string> nodes;
  for (const auto& [node, count] : run.drops()) nodes.insert(node);
  std::vector<OperatorChange> all;
  for (std::uint32_t i = 0; i < run.map().signals().size(); ++i) {
    const auto& entry = run.map().entry(SignalId{i});
    if (nodes.count(entry.partition->node) > 0 || !run.has(entry.name)) continue;
    if (!host_of_gateway(entry.partition->name).empty()) continue;
    const auto changes = changes_of(run, entry.name);
    if (changes.size() <= kMostChanges) all.insert(all.end(), changes.begin(), changes.end());
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const auto& a, const auto& b) { return a.time < b.time; });
  return all;
}

}  // namespace rths::report
