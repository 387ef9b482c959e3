// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/sim/composition.hpp>

namespace rths::sim {
namespace {

constexpr std::string_view kStages[] = {"actuator",  "motion",  "vertical", "modifier",
                                        "restoring", "machine", "sensor"};

bool is_of_a_specimen(Stage stage) {
  return stage == Stage::Vertical || stage == Stage::Modifier || stage == Stage::Restoring;
}

// In the order of SensorChannel.
constexpr ChannelName kChannels[] = {
    {"force", "N"}, {"displacement", "m"}, {"acceleration", "m/s2"}, {"axial_load", "N"}};

unsigned read_axes(const Config& table, const TermKind& kind) {
  if (!table.has("axes")) return kBothAxes;
  if ((kind.traits & kPerAxis) == 0)
    table.fail("axes",
               fmt::format("'{}' couples both axes; it cannot be limited to one", kind.name));
  unsigned axes = 0;
  for (const auto& axis : table.texts("axes")) {
    const auto found = horizontal_axis_named(axis);
    if (!found)
      table.fail("axes", fmt::format("axis '{}' is not known, expected long or lat", axis));
    axes |= 1U << index_of(*found);
  }
  if (axes == 0) table.fail("axes", "axes is empty, expected long, lat or both");
  return axes;
}

SensorChannel read_channel(const Config& table, const TermKind& kind) {
  if (!table.has("channel")) return SensorChannel::Force;
  if ((kind.traits & kPerChannel) == 0)
    table.fail("channel", fmt::format("'{}' has no selectable channel", kind.name));
  const std::string name = table.text("channel");
  for (std::size_t i = 0; i < std::size(kChannels); ++i) {
    if (kChannels[i].channel != name) continue;
    const auto channel = static_cast<SensorChannel>(i);
    if (channel == SensorChannel::AxialLoad && (kind.traits & kPerAxis) == 0)
      table.fail("channel", fmt::format("'{}' acts between the horizontal axes; the axial load has "
                                        "no axes",
                                        kind.name));
    if (channel == SensorChannel::AxialLoad && table.has("axes"))
      table.fail("axes", "axes is set, but the axial load has no axes");
    return channel;
  }
  table.fail("channel", fmt::format("channel is '{}', expected force, displacement, acceleration "
                                    "or axial_load",
                                    name));
}

// The values of a key: none, one for both axes, or one per axis.
std::vector<double> read_values(const Config& table, const std::string& key, const TermKind& kind,
                                SensorChannel channel) {
  if (!table.has(key)) return {};
  if (!table.is_array(key)) return {table.number(key)};
  auto values = table.numbers(key);
  if (channel == SensorChannel::AxialLoad)
    table.fail(key, fmt::format("{} is an array, but the axial load has no axes", key));
  if (table.has("axes"))
    table.fail(key,
               fmt::format("{} is an array [long, lat] and axes is set: expected only one of the "
                           "two",
                           key));
  if ((kind.traits & kPerAxis) == 0)
    table.fail(key, fmt::format("{} is an array, but '{}' couples both axes", key, kind.name));
  if (values.size() != kHorizontalAxes)
    table.fail(key, fmt::format("{} has {} numbers, expected [long, lat]", key, values.size()));
  return values;
}

void check_bounds(const Config& table, const std::string& key, const Parameter& parameter,
                  double value) {
  if (!(value >= parameter.low && value <= parameter.high))
    table.fail(
        key, fmt::format("{} is {}, expected {} to {}", key, value, parameter.low, parameter.high));
}

// The same term once for each axis.
std::vector<TermSettings> by_axis(const TermSettings& settings) {
  std::vector<TermSettings> axes(kHorizontalAxes, settings);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i].name += fmt::format(".{}", name_of(kHorizontal[i]));
    axes[i].axes = 1U << i;
  }
  return axes;
}

// One term, or one per axis if a parameter is an array.
std::vector<TermSettings> read_term(const std::string& name, const Config& table,
                                    ParameterBounds bounds) {
  TermSettings settings;
  settings.kind = table.text("kind", name);
  settings.name = name;
  const TermKind& kind =
      table.placed("kind", [&]() -> const TermKind& { return term_kind(settings.kind); });
  const bool enabled = table.flag("enabled", true);
  settings.axes = read_axes(table, kind);
  settings.channel = read_channel(table, kind);
  std::vector<TermSettings> axes;
  for (const auto& parameter : kind.parameters) {
    const std::string key = parameter_key(parameter, settings.channel);
    const auto values = read_values(table, key, kind, settings.channel);
    for (const double value : values)
      if (bounds == ParameterBounds::Catalogue) check_bounds(table, key, parameter, value);
    if (values.size() == kHorizontalAxes && axes.empty()) axes = by_axis(settings);
    if (values.empty()) continue;
    settings.parameters.emplace_back(parameter.name, values[0]);
    for (std::size_t i = 0; i < axes.size(); ++i)
      axes[i].parameters.emplace_back(parameter.name, values[std::min(i, values.size() - 1)]);
  }
  table.reject_unknown_keys();
  if (!enabled) return {};
  return axes.empty() ? std::vector{settings} : axes;
}

}  // namespace

const ChannelName& name_of(SensorChannel channel) {
  return kChannels[static_cast<std::size_t>(channel)];
}

std::string_view stage_name(Stage stage) { return kStages[static_cast<std::size_t>(stage)]; }

void check_owner(const TermSettings& term, TermOwner owner) {
  const TermKind& kind = term_kind(term.kind);
  const std::string& name = name_of(term);
  if (owner != TermOwner::Any && (kind.traits & kControlled) != 0)
    throw Error{
        fmt::format("term '{}' needs a control current, an input that neither specimens nor "
                    "machines have",
                    name)};
  if (owner == TermOwner::Machine && is_of_a_specimen(kind.stage))
    throw Error{
        fmt::format("term '{}' belongs to the specimen (stage {}), expected one of the stages "
                    "actuator, motion, machine or sensor",
                    name, stage_name(kind.stage))};
  if (owner != TermOwner::Specimen) return;
  if (kind.stage == Stage::Actuator || kind.stage == Stage::Sensor)
    throw Error{fmt::format("term '{}' belongs to the machine (stage {}), not to a specimen", name,
                            stage_name(kind.stage))};
  // A specimen's acceleration is unknown until its force has been computed.
  if ((kind.traits & kInertial) != 0)
    throw Error{
        fmt::format("term '{}' needs the acceleration, an input that a specimen does not have; it "
                    "belongs to the machine",
                    name)};
}

std::string parameter_key(const Parameter& parameter, SensorChannel channel) {
  std::string unit{parameter.unit};
  if (unit.starts_with(kChannelUnit)) unit.replace(0, kChannelUnit.size(), name_of(channel).unit);
  if (unit == "-") return std::string{parameter.name};
  std::string key = fmt::format("{}_", parameter.name);
  for (const char c : unit) {
    if (c == '/')
      key += "_per_";
    else
      key += c == '*' ? '_' : c;
  }
  return key;
}

std::vector<TermSettings> read_terms(const Config& table, TermOwner owner, ParameterBounds bounds) {
  std::vector<TermSettings> terms;
  for (const auto& key : table.keys()) {
    if (!table.is_table(key)) continue;
    const auto read = read_term(key, table.table(key), bounds);
    for (const auto& term : read) table.placed(key, [&] { check_owner(term, owner); });
    terms.insert(terms.end(), read.begin(), read.end());
  }
  return terms;
}

}  // namespace rths::sim
