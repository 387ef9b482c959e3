// SPDX-License-Identifier: Apache-2.0
//
// Reads *.ringmap.toml into a MapDescription. map_rules.cpp checks the content.
#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "map_rules.hpp"

namespace rths::memmap {
namespace {

constexpr std::int64_t kLargestOffset = (std::int64_t{128} << 20) - 1;

WordType read_type(const Config& table) {
  const std::string type = table.text("type");
  for (const WordType known : {WordType::I32, WordType::U32, WordType::F32})
    if (type == to_text(known)) return known;
  table.fail("type", fmt::format("type is '{}', expected i32, u32 or f32", type));
}

// Accepts the unit of the laboratory's sheet: longwords, bytes, or locations counted from 1.
LongwordOffset read_offset(const Config& table) {
  const int given = table.has("offset") + table.has("byte_offset") + table.has("location");
  if (given != 1)
    throw Error{fmt::format("{}: {} of offset, byte_offset and location given, expected one",
                            table.where(), given == 0 ? "none" : "more than one")};
  if (table.has("location"))
    return to_longword_offset(
        Location{static_cast<std::uint32_t>(table.integer_in("location", 1, kLargestOffset))});
  if (table.has("offset"))
    return LongwordOffset{
        static_cast<std::uint32_t>(table.integer_in("offset", 0, kLargestOffset))};
  const ByteOffset bytes{
      static_cast<std::uint32_t>(table.integer_in("byte_offset", 0, kLargestOffset))};
  if (!is_aligned(bytes))
    table.fail("byte_offset", fmt::format("byte_offset is {}, expected a multiple of {}",
                                          bytes.value(), kBytesPerLongword));
  return to_longword_offset(bytes);
}

void read_range(const Config& table, Signal& signal) {
  if (!table.has("range")) return;
  const auto bounds = table.numbers("range");
  if (bounds.size() != 2)
    table.fail("range", fmt::format("range has {} numbers, expected two: lowest and highest",
                                    bounds.size()));
  signal.range = {bounds[0], bounds[1]};
}

void read_values(const Config& table, Signal& signal) {
  if (!table.has("values")) return;
  const Config values = table.table("values");
  for (const auto& name : values.keys()) signal.values.emplace_back(name, values.integer(name));
}

Signal read_signal(const Config& table) {
  Signal signal;
  signal.name = table.text("name");
  signal.offset = read_offset(table);
  signal.type = read_type(table);
  signal.unit = table.text("unit", "1");
  signal.initial = table.number("initial", 0);
  signal.interrupt = table.flag("interrupt", false);
  signal.event = table.flag("event", false);
  signal.where = table.where();
  read_range(table, signal);
  read_values(table, signal);
  return signal;
}

// `index = ["long", "lat"]` expands to one signal each: long.displ.ref, lat.displ.ref.
void append_signals(const Config& table, std::vector<Signal>& signals) {
  const Signal first = read_signal(table);
  if (!table.has("index")) {
    signals.push_back(first);
  } else {
    const auto indices = table.texts("index");
    if (indices.empty()) table.fail("index", "index is empty, expected at least one name");
    for (std::uint32_t i = 0; i < indices.size(); ++i) {
      Signal word = first;
      word.name = indices[i] + "." + first.name;
      word.offset = advance(first.offset, i);
      signals.push_back(std::move(word));
    }
  }
  table.reject_unknown_keys();
}

// True for "latest".
bool read_replication(const Config& table) {
  const std::string text = table.text("replication", "every");
  if (text != "every" && text != "latest")
    table.fail("replication", fmt::format("replication is '{}', expected every or latest", text));
  return text == "latest";
}

void read_partition(const Config& table, MapDescription& description, Mistakes& mistakes) {
  Partition partition;
  const bool is_read = mistakes.collect([&] {
    partition.name = table.text("name");
    partition.node = table.text("node");
    partition.base = read_offset(table);
    partition.longwords =
        static_cast<std::uint32_t>(table.integer_in("longwords", 1, kLargestOffset));
    partition.tear_group = table.flag("tear_group", false);
    partition.latest = read_replication(table);
    partition.where = table.where();
    static_cast<void>(table.tables("signal"));
    table.reject_unknown_keys();
  });
  for (const auto& signal : table.tables("signal"))
    mistakes.collect([&] { append_signals(signal, partition.signals); });
  if (is_read) description.partitions.push_back(std::move(partition));
}

void read_ring(const Config& ring, MapDescription& description) {
  description.name = ring.text("name");
  description.version = static_cast<std::uint32_t>(ring.integer_in("version", 1, 1'000'000));
  const std::int64_t bytes = ring.integer_in("size_bytes", 4096, std::int64_t{128} << 20);
  if (bytes % 4096 != 0)
    ring.fail("size_bytes", fmt::format("size_bytes is {}, expected a multiple of 4096", bytes));
  description.size_longwords = static_cast<std::uint32_t>(bytes / kBytesPerLongword);
  ring.reject_unknown_keys();
}

void read_nodes(const Config& nodes, MapDescription& description) {
  constexpr std::int64_t kLargestNodeId = 255;
  for (const auto& name : nodes.keys())
    description.nodes.push_back(
        {name, NodeId{static_cast<std::uint16_t>(nodes.integer_in(name, 0, kLargestNodeId))},
         nodes.where(name)});
}

// Throws all mistakes of the file at once. The rules need the ring's size and its nodes.
MapDescription read_description(const Config& file) {
  const std::int64_t format = file.integer("ringmap");
  if (format != kMapFormat)
    file.fail("ringmap", fmt::format("ringmap is {}, this program reads {}", format, kMapFormat));
  MapDescription description;
  Mistakes mistakes;
  description.where = file.where("nodes");
  const bool has_ring = mistakes.collect([&] { read_ring(file.table("ring"), description); });
  const bool has_nodes = mistakes.collect([&] { read_nodes(file.table("nodes"), description); });
  mistakes.collect([&] {
    for (const auto& table : file.tables("partition")) read_partition(table, description, mistakes);
  });
  static_cast<void>(file.table_or_empty("roles"));  // for reports, which read it themselves
  mistakes.collect([&] { file.reject_unknown_keys(); });
  sort_canonically(description);
  if (has_ring && has_nodes) check_rules(description, mistakes);
  mistakes.report();
  return description;
}

}  // namespace

Map load_map(const std::filesystem::path& file) {
  return Map{read_description(Config::load(file))};
}

Map parse_map(std::string_view text, const std::string& name) {
  return Map{read_description(Config::parse(text, name))};
}

}  // namespace rths::memmap
