// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/assign.hpp>

#include <charconv>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/units.hpp>

namespace rths::broker {
namespace {

struct Assignment {
  const memmap::SignalEntry* entry;
  std::uint32_t word;
};

// Parses "12.5mm", "0.5", or the name of one of the signal's values; returns SI.
double parse_value(const std::string& text, const memmap::SignalEntry& entry) {
  const memmap::Codec codec{*entry.signal};
  for (const auto& [name, value] : entry.signal->values)
    if (name == text) return codec.to_si(static_cast<double>(value));
  double number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, problem] = std::from_chars(text.data(), end, number);
  if (problem != std::errc{})
    throw Error{fmt::format("{}={}: expected a number{}", entry.name, text,
                            entry.signal->values.empty() ? "" : " or a named value")};
  if (!std::isfinite(number))
    throw Error{fmt::format("{}={}: expected a finite number", entry.name, text)};
  if (rest == end) return codec.to_si(number);
  const auto unit = memmap::parse_unit(std::string{rest, end});
  const std::string si = memmap::parse_unit(entry.signal->unit).si;
  if (unit.si != si)
    throw Error{fmt::format("{}={}: the unit '{}' does not convert to {}, the signal's unit",
                            entry.name, text, std::string{rest, end}, entry.signal->unit)};
  return unit.scale * number + unit.offset;
}

void check_range(double si, const std::string& text, const memmap::SignalEntry& entry) {
  if (!entry.signal->range) return;
  const double value = memmap::Codec{*entry.signal}.from_si(si);
  const auto [low, high] = *entry.signal->range;
  if (value < low || value > high)
    throw Error{fmt::format("{}={}: expected {} to {} {}", entry.name, text, low, high,
                            entry.signal->unit)};
}

// The signals of the partition that a name begins with, else the partitions.
std::vector<std::string> signals_beside(const std::string& name, const memmap::Map& map) {
  std::vector<std::string> signals, partitions;
  for (const auto& partition : map.partitions()) {
    partitions.push_back(partition.name + ".…");
    if (!name.starts_with(partition.name + ".")) continue;
    for (const auto& signal : partition.signals)
      signals.push_back(partition.name + "." + signal.name);
  }
  return signals.empty() ? partitions : signals;
}

const memmap::SignalEntry& entry_named(const std::string& name, const memmap::Map& map) {
  if (const auto found = map.find_signal(name)) return map.entry(*found);
  std::string hint = did_you_mean(name, map.signal_names());
  if (hint.empty()) hint = did_you_mean_one_of(name, signals_beside(name, map));
  throw Error{
      fmt::format("the ring's map '{}' has no signal '{}'{}", map.description().name, name, hint)};
}

Assignment parse_assignment(const std::string& text, const memmap::Map& map) {
  const auto assignment = key_value(text);
  if (!assignment) throw Error{fmt::format("'{}': expected name=value", text)};
  const auto& [name, value] = *assignment;
  const auto& entry = entry_named(name, map);
  const double si = parse_value(value, entry);
  check_range(si, value, entry);
  const memmap::Codec codec{*entry.signal};
  const std::uint32_t word = codec.encode(si);
  if (!std::isfinite(codec.decode(word)))
    throw Error{fmt::format("{}={}: too large for the type of the word", entry.name, value)};
  return {&entry, word};
}

void write_all(Ring& ring, const std::string& node, const std::vector<Assignment>& assignments) {
  Node writer = ring.join(node, 0);
  for (const auto& [entry, word] : assignments) {
    if (!entry->partition->tear_group) {
      static_cast<void>(writer.write(entry->signal->offset, word));
      continue;
    }
    const TearGroupId group = ring.tear_group(entry->partition->name);
    std::vector<std::uint32_t> words(entry->partition->longwords);
    if (writer.read_group(group, words) != Status::Ok)
      throw Error{fmt::format("partition '{}': a write is in progress", entry->partition->name)};
    words[entry->signal->offset.value() - entry->partition->base.value()] = word;
    static_cast<void>(writer.write_group(group, words));
  }
}

}  // namespace

void assign(Ring& ring, const std::vector<std::string>& assignments) {
  // Parses everything before it writes anything.
  std::map<std::string, std::vector<Assignment>> by_writer;
  for (const auto& text : assignments) {
    const Assignment assignment = parse_assignment(text, ring.map());
    by_writer[assignment.entry->partition->node].push_back(assignment);
  }
  for (const auto& [node, words] : by_writer) write_all(ring, node, words);
}

}  // namespace rths::broker
