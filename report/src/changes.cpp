// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include <rths/controller/safety.hpp>
#include <rths/core/axis.hpp>

#include "analysis.hpp"
#include "conditions.hpp"

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

using controller::SafetyCause;
using controller::SafetyState;

std::string prefix_of(const Reader& run) {
  return "monitor." + recording::roles_of(run).machine + ".safety.";
}

// NaN rows are missing.
bool is_code(double value, int count) { return value >= 0 && value < count; }

// The axis after those of the roles is the vertical one.
std::string axis_name(const Reader& run, double axis) {
  const auto axes = recording::roles_of(run).axes;
  const auto count = static_cast<int>(axes.size());
  if (!is_code(axis, count + 1)) return "an axis";
  const auto index = static_cast<std::size_t>(axis);
  return index < axes.size() ? axes[index].axis : name_of(Axis::Vert);
}

std::string text_of(const Reader& run, std::size_t row) {
  const std::string prefix = prefix_of(run);
  const auto value = [&](const char* name) { return run.signal(prefix + name)[row]; };
  const auto cause = static_cast<SafetyCause>(value("trip"));
  const bool is_node = cause == SafetyCause::NodeSilent || cause == SafetyCause::NodeInvalid;
  const std::string of = is_node ? "a node" : axis_name(run, value("axis"));
  const auto [quantity, unit] = to_text(cause);
  return fmt::format("{} of {} is {:.4g} {}", quantity, of, value("value"), unit);
}

// Row of the first trip.
std::optional<std::size_t> find_trip(const Reader& run) {
  const std::string signal = prefix_of(run) + "trip";
  if (!run.has(signal)) return std::nullopt;
  const auto trip = run.signal(signal);
  const auto at = std::ranges::find_if(
      trip, [](double value) { return value > 0 && is_code(value, controller::kSafetyCauses); });
  if (at == trip.end()) return std::nullopt;
  return static_cast<std::size_t>(at - trip.begin());
}

// A stop by the word of the operator, without a trip.
Break operator_stop(const Reader& run) {
  const std::string word = "tune." + recording::roles_of(run).machine + ".safety.stop";
  if (!run.has(word)) return {};
  const auto values = run.signal(word);
  const auto at = std::ranges::find_if(values, [](double value) { return value > 0; });
  if (at == values.end()) return {};
  return Broken{"safety", run.time()[static_cast<std::size_t>(at - values.begin())], word,
                "a stop by the operator", "none"};
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
  std::ranges::stable_sort(all, [](const auto& a, const auto& b) { return a.time < b.time; });
  return all;
}

Break safety_of(const Reader& run) {
  const auto row = find_trip(run);
  if (!row) return operator_stop(run);
  const double limit = run.signal(prefix_of(run) + "limit")[*row];
  const std::string late = lateness_before(run, run.time()[*row]);
  const auto cause = static_cast<SafetyCause>(run.signal(prefix_of(run) + "trip")[*row]);
  return Broken{"safety", run.time()[*row], prefix_of(run) + "trip",
                (late.empty() ? "" : late + ", then ") + text_of(run, *row),
                limit > 0 ? fmt::format("at most {:.4g} {}", limit, to_text(cause).unit)
                          : "none, or a number"};
}

std::vector<SafetyChange> safety_changes(const Reader& run) {
  const std::string signal = prefix_of(run) + "state";
  std::vector<SafetyChange> changes;
  if (!run.has(signal)) return changes;
  const auto state = run.signal(signal);
  const auto trip = find_trip(run);
  for (std::size_t i = 0; i < state.size(); ++i) {
    if (trip == i) changes.push_back({run.time()[i], "trip", text_of(run, i)});
    const bool is_new = i == 0 || state[i] != state[i - 1];
    if (is_new && is_code(state[i], controller::kSafetyStates))
      changes.push_back({run.time()[i], to_text(static_cast<SafetyState>(state[i])), ""});
  }
  return changes;
}

}  // namespace rths::report
