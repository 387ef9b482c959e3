// SPDX-License-Identifier: Apache-2.0
#include "map_rules.hpp"

#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/memmap/units.hpp>

namespace rths::memmap {
namespace {

template <class... Args>
[[noreturn]] void fail(const std::string& where, fmt::format_string<Args...> message,
                       Args&&... args) {
  throw Error{where + (where.empty() ? "" : ": ") +
              fmt::format(message, std::forward<Args>(args)...)};
}

void check_name(const std::string& name, const std::string& kind, const std::string& where) {
  const auto allowed = [](char c) { return is_letter_or_digit(c) || c == '_' || c == '.'; };
  if (name.empty() || !std::all_of(name.begin(), name.end(), allowed) || name.front() == '.' ||
      name.back() == '.')
    fail(where, "{} name is '{}', expected letters, digits, '_' and inner '.'", kind, name);
}

// The canonical form of a map has these names as bare keys of TOML.
bool is_key(const std::string& name, const std::string& others) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [&](char c) {
    return is_letter_or_digit(c) || others.find(c) != std::string::npos;
  });
}

// Without '-': the name of a node is also part of the names of its added partitions.
void check_node_name(const MapNode& node) {
  if (!is_key(node.name, "_"))
    fail(node.where, "node name is '{}', expected letters, digits and '_'", node.name);
}

void check_nodes(const MapDescription& description, Mistakes& mistakes) {
  mistakes.collect([&] {
    if (description.nodes.empty())
      fail(description.where, "map '{}' has no nodes", description.name);
  });
  for (const auto& node : description.nodes) mistakes.collect([&] { check_node_name(node); });
  for (std::size_t i = 1; i < description.nodes.size(); ++i) {
    const MapNode& node = description.nodes[i];
    const MapNode& previous = description.nodes[i - 1];
    mistakes.collect([&] {
      if (node.id == previous.id)
        fail(node.where, "nodes '{}' and '{}' both have id {}", previous.name, node.name,
             node.id.value());
    });
  }
}

void check_partition(const Partition& partition, const MapDescription& description) {
  check_name(partition.name, "partition", partition.where);
  std::string known;
  for (const auto& node : description.nodes) known += (known.empty() ? "" : ", ") + node.name;
  const auto is_writer = [&](const MapNode& node) { return node.name == partition.node; };
  const auto& nodes = description.nodes;  // none: a mistake of the map, not of this partition
  if (!nodes.empty() && std::none_of(nodes.begin(), nodes.end(), is_writer))
    fail(partition.where, "partition '{}' is written by '{}', expected one of {}", partition.name,
         partition.node, known);
  const std::uint64_t end = std::uint64_t{partition.base.value()} + partition.longwords;
  if (end > description.size_longwords)
    fail(partition.where, "partition '{}' ends at longword {}, the ring has {}", partition.name,
         end, description.size_longwords);
  if (partition.longwords == 0) fail(partition.where, "partition '{}' is empty", partition.name);
}

void check_overlap(const Partition& low, const Partition& high) {
  if (advance(low.base, low.longwords) <= high.base) return;
  if (low.node != high.node)
    fail(high.where, "longword {} has two writers: '{}' (partition '{}') and '{}' ('{}')",
         high.base.value(), low.node, low.name, high.node, high.name);
  fail(high.where, "partition '{}' starts at longword {}, inside partition '{}' ({} to {})",
       high.name, high.base.value(), low.name, low.base.value(),
       low.base.value() + low.longwords - 1);
}

void check_integer_values(const Signal& signal) {
  if (signal.values.empty()) return;
  if (signal.type == WordType::F32)
    fail(signal.where, "signal '{}' names values but is f32, expected i32 or u32", signal.name);
  const bool is_signed = signal.type == WordType::I32;
  const std::int64_t low = is_signed ? std::numeric_limits<std::int32_t>::min() : 0;
  const std::int64_t high = is_signed ? std::numeric_limits<std::int32_t>::max()
                                      : std::numeric_limits<std::uint32_t>::max();
  for (std::size_t i = 0; i < signal.values.size(); ++i) {
    const auto& [name, value] = signal.values[i];
    if (!is_key(name, "_-"))
      fail(signal.where,
           "signal '{}': the name of value {} is '{}', expected letters, digits, '_' and '-'",
           signal.name, value, name);
    if (value < low || value > high)
      fail(signal.where, "signal '{}': value {} = {} does not fit {}", signal.name, name, value,
           to_text(signal.type));
    if (i > 0 && value == signal.values[i - 1].second)
      fail(signal.where, "signal '{}': '{}' and '{}' are both {}", signal.name,
           signal.values[i - 1].first, name, value);
  }
}

void check_range(const Signal& signal) {
  if (!std::isfinite(signal.initial))
    fail(signal.where, "signal '{}': initial is not finite", signal.name);
  if (!signal.range) return;
  const auto [low, high] = *signal.range;
  if (!(low < high))
    fail(signal.where, "signal '{}': range runs from {} to {}, expected lowest first", signal.name,
         low, high);
  if (signal.initial < low || signal.initial > high)
    fail(signal.where, "signal '{}': initial {} is outside its range {} to {}", signal.name,
         signal.initial, low, high);
}

void check_place(const Signal& signal, const Partition& partition) {
  if (signal.offset < partition.base ||
      signal.offset >= advance(partition.base, partition.longwords))
    fail(signal.where, "signal '{}' is at longword {}, outside partition '{}' ({} to {})",
         signal.name, signal.offset.value(), partition.name, partition.base.value(),
         partition.base.value() + partition.longwords - 1);
}

void check_unit(const Signal& signal) {
  try {
    static_cast<void>(parse_unit(signal.unit));
  } catch (const Error& error) {
    fail(signal.where, "signal '{}': {}", signal.name, error.what());
  }
}

void check_signal(const Signal& signal, const Partition& partition, Mistakes& mistakes) {
  mistakes.collect([&] { check_name(signal.name, "signal", signal.where); });
  mistakes.collect([&] { check_place(signal, partition); });
  mistakes.collect([&] { check_unit(signal); });
  mistakes.collect([&] { check_integer_values(signal); });
  mistakes.collect([&] { check_range(signal); });
}

void check_signals(const Partition& partition, std::set<std::string>& names, Mistakes& mistakes) {
  for (std::size_t i = 0; i < partition.signals.size(); ++i) {
    const Signal& signal = partition.signals[i];
    check_signal(signal, partition, mistakes);
    mistakes.collect([&] {
      if (i > 0 && signal.offset == partition.signals[i - 1].offset)
        fail(signal.where, "signals '{}' and '{}' are both at longword {}",
             partition.signals[i - 1].name, signal.name, signal.offset.value());
    });
    mistakes.collect([&] {
      if (!names.insert(partition.name + "." + signal.name).second)
        fail(signal.where, "there are two signals '{}.{}'", partition.name, signal.name);
    });
  }
}

}  // namespace

void Mistakes::report() const {
  if (!lines_.empty()) throw Error{lines_};
}

void check_rules(const MapDescription& description, Mistakes& mistakes) {
  mistakes.collect([&] { check_name(description.name, "ring", description.where); });
  check_nodes(description, mistakes);
  const auto& partitions = description.partitions;
  for (const auto& partition : partitions)
    mistakes.collect([&] { check_partition(partition, description); });
  for (std::size_t i = 1; i < partitions.size(); ++i)
    mistakes.collect([&] { check_overlap(partitions[i - 1], partitions[i]); });
  std::set<std::string> partition_names;
  std::set<std::string> signal_names;
  for (const auto& partition : partitions) {
    const bool is_new = mistakes.collect([&] {
      if (!partition_names.insert(partition.name).second)
        fail(partition.where, "there are two partitions '{}'", partition.name);
    });
    // Equal names of signals would only repeat the mistake.
    std::set<std::string> others;
    check_signals(partition, is_new ? signal_names : others, mistakes);
  }
}

void sort_canonically(MapDescription& description) {
  const auto by_offset = [](const Signal& a, const Signal& b) { return a.offset < b.offset; };
  const auto by_base = [](const Partition& a, const Partition& b) { return a.base < b.base; };
  std::sort(description.nodes.begin(), description.nodes.end(),
            [](const MapNode& a, const MapNode& b) { return a.id < b.id; });
  std::stable_sort(description.partitions.begin(), description.partitions.end(), by_base);
  for (auto& partition : description.partitions) {
    std::stable_sort(partition.signals.begin(), partition.signals.end(), by_offset);
    for (auto& signal : partition.signals)
      std::sort(signal.values.begin(), signal.values.end(),
                [](const auto& a, const auto& b) { return a.second < b.second; });
  }
}

}  // namespace rths::memmap
