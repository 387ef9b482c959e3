// SPDX-License-Identifier: Apache-2.0
#include <rths/memmap/map.hpp>

#include <fmt/format.h>
#include <xxhash.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

#include "map_rules.hpp"

namespace rths::memmap {
namespace {

// With a point or an exponent, so that it reads back as a floating-point number.
std::string number_toml(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string signal_toml(const Signal& signal) {
  std::string text = fmt::format(
      "[[partition.signal]]\nname = \"{}\"\noffset = {}\ntype = \"{}\"\nunit = \"{}\"\n",
      signal.name, signal.offset.value(), to_text(signal.type), signal.unit);
  if (signal.range)
    text += fmt::format("range = [{}, {}]\n", number_toml(signal.range->first),
                        number_toml(signal.range->second));
  if (signal.initial != 0) text += fmt::format("initial = {}\n", number_toml(signal.initial));
  if (!signal.values.empty()) {
    text += "values = {";
    for (const auto& [name, value] : signal.values)
      text += fmt::format("{}{} = {}", text.back() == '{' ? " " : ", ", name, value);
    text += " }\n";
  }
  if (signal.interrupt) text += "interrupt = true\n";
  if (signal.event) text += "event = true\n";
  return text;
}

std::string partition_toml(const Partition& partition) {
  std::string text =
      fmt::format("[[partition]]\nname = \"{}\"\nnode = \"{}\"\noffset = {}\nlongwords = {}\n",
                  partition.name, partition.node, partition.base.value(), partition.longwords);
  if (partition.tear_group) text += "tear_group = true\n";
  if (partition.latest) text += "replication = \"latest\"\n";
  for (const auto& signal : partition.signals) text += signal_toml(signal);
  return text;
}

}  // namespace

const char* to_text(WordType type) noexcept {
  constexpr const char* kNames[] = {"i32", "u32", "f32"};
  return kNames[static_cast<std::size_t>(type)];
}

Map::Map(MapDescription description) : description_{std::move(description)} {
  sort_canonically(description_);
  Mistakes mistakes;
  check_rules(description_, mistakes);
  mistakes.report();
  for (const auto& partition : description_.partitions) {
    for (const auto& signal : partition.signals) {
      by_name_.emplace(partition.name + "." + signal.name,
                       static_cast<std::uint32_t>(signals_.size()));
      signals_.push_back({partition.name + "." + signal.name, &signal, &partition});
    }
  }
  const std::string canonical = to_toml();
  hash_ = XXH3_64bits(canonical.data(), canonical.size());
}

std::optional<SignalId> Map::find_signal(const std::string& full_name) const {
  const auto found = by_name_.find(full_name);
  if (found == by_name_.end()) return std::nullopt;
  return SignalId{found->second};
}

std::vector<std::string> Map::signal_names() const {
  std::vector<std::string> names;
  for (const auto& entry : signals_) names.push_back(entry.name);
  return names;
}

SignalId Map::signal(const std::string& full_name) const {
  if (const auto found = find_signal(full_name)) return *found;
  throw Error{fmt::format("map '{}' has no signal '{}'{}", description_.name, full_name,
                          did_you_mean(full_name, signal_names()))};
}

NodeId Map::node(const std::string& name) const {
  std::string known;
  for (const auto& node : description_.nodes) {
    if (node.name == name) return node.id;
    known += (known.empty() ? "" : ", ") + node.name;
  }
  throw Error{
      fmt::format("map '{}' has no node '{}', expected one of {}", description_.name, name, known)};
}

std::string Map::node_name(NodeId id) const {
  for (const auto& node : description_.nodes)
    if (node.id == id) return node.name;
  return std::to_string(id.value());
}

const Partition* Map::partition_at(LongwordOffset offset) const {
  for (const auto& partition : description_.partitions)
    if (offset >= partition.base && offset < advance(partition.base, partition.longwords))
      return &partition;
  return nullptr;
}

std::string Map::to_toml() const {
  std::string text = fmt::format(
      "ringmap = {}\n[ring]\nname = \"{}\"\nversion = {}\nsize_bytes = {}\n[nodes]\n", kMapFormat,
      description_.name, description_.version, description_.size_longwords * kBytesPerLongword);
  for (const auto& node : description_.nodes)
    text += fmt::format("{} = {}\n", node.name, node.id.value());
  for (const auto& partition : description_.partitions) text += partition_toml(partition);
  return text;
}

std::string hash_text(std::uint64_t hash) { return fmt::format("{:016x}", hash); }

}  // namespace rths::memmap
