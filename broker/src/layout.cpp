// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/detail/layout.hpp>

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include <rths/broker/detail/card_layout.hpp>
#include <rths/broker/detail/process.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>

#include "journal.hpp"
#include "record.hpp"

namespace rths::broker {
namespace {

constexpr std::uint32_t kFewestBits = 6;
constexpr std::uint32_t kMostBits = 24;
constexpr std::uint64_t kGroupsAt = kWakeAt + sizeof(Wake);
static_assert(kGroupsAt % alignof(Group) == 0);

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t to) {
  return (value + to - 1) / to * to;
}

std::uint64_t journal_stride(const Header& h) {
  return round_up(journal_bytes(static_cast<std::uint32_t>(h.journal_bits)), kPageBytes);
}

// A journal has space for at least a few writes of the largest group of its map.
std::uint32_t enough_bits(const memmap::Map& map, std::uint32_t bits) {
  std::uint64_t largest = 0;
  for (const auto& partition : map.partitions())
    if (partition.tear_group) largest = std::max<std::uint64_t>(largest, partition.longwords);
  bits = std::clamp(bits, kFewestBits, kMostBits);
  while (bits < kMostBits && (std::uint64_t{1} << bits) < 8 * (largest / 3 + 2)) ++bits;
  return bits;
}

void fill_groups(std::byte* base, const Header& header, const memmap::Map& map) {
  auto* entry = reinterpret_cast<Group*>(base + header.groups_at);
  for (const Group& group : plan_groups(map)) {
    *entry++ = group;
    disable_record(reinterpret_cast<std::uint32_t*>(base + header.records_at + group.record_at));
  }
}

void check_sizes(const Header& header) {
  if (header.map_text_bytes > kMostMapText)
    throw Error{fmt::format("the text of the map has {} bytes, expected at most {}",
                            header.map_text_bytes, kMostMapText)};
  if (header.cards_at - header.journals_at > kMostJournals)
    throw Error{fmt::format("the journals have {} bytes, expected at most {}",
                            header.cards_at - header.journals_at, kMostJournals)};
}

}  // namespace

std::uint32_t node_index(const memmap::Map& map, NodeId node) {
  const auto& nodes = map.description().nodes;
  const auto found = std::find_if(nodes.begin(), nodes.end(),
                                  [&](const auto& candidate) { return candidate.id == node; });
  return static_cast<std::uint32_t>(found - nodes.begin());
}

Header plan_layout(const memmap::Map& map, const std::string& map_text,
                   std::uint32_t journal_bits) {
  Header header{};
  header.magic = kMagic;
  header.layout_version = kLayoutVersion;
  header.map_hash = map.hash();
  header.groups_at = kGroupsAt;
  for (const auto& partition : map.partitions()) {
    if (!partition.tear_group) continue;
    ++header.group_count;
    header.records_bytes += record_bytes(partition.longwords);
  }
  header.records_at = round_up(kGroupsAt + header.group_count * sizeof(Group), kPairBytes);
  header.map_text_at = header.records_at + header.records_bytes;
  header.map_text_bytes = map_text.size();
  header.memory_at = round_up(header.map_text_at + header.map_text_bytes, kPageBytes);
  header.memory_bytes = std::uint64_t{map.description().size_longwords} * 4;
  header.journals_at = header.memory_at + header.memory_bytes;
  header.journal_bits = enough_bits(map, journal_bits);
  header.journal_count = map.description().nodes.size();
  header.cards_at = journal_at(header, static_cast<std::uint32_t>(header.journal_count));
  header.card_bytes = card_size(header.memory_bytes);
  header.card_count = kMaxSlots;
  check_sizes(header);
  return header;
}

std::uint64_t total_bytes(const Header& header) {
  return header.cards_at + header.card_count * header.card_bytes;
}

std::uint64_t common_bytes(const Header& header) { return header.journals_at; }

bool is_same_layout(const Header& a, const Header& b) {
  const auto layout = [](Header header) {
    header.creator = 0;
    header.cards_in_use = 0;
    header.looks = 0;
    header.is_replicated = 0;
    header.fault = 0;
    header.watcher = 0;
    return header;
  };
  return layout(a) == layout(b);
}

std::vector<Group> plan_groups(const memmap::Map& map) {
  std::vector<Group> groups;
  std::uint32_t record_at = 0;
  for (const auto& partition : map.partitions()) {
    if (!partition.tear_group) continue;
    groups.push_back({partition.base.value(), partition.longwords,
                      node_index(map, map.node(partition.node)), record_at, 0});
    record_at += static_cast<std::uint32_t>(record_bytes(partition.longwords));
  }
  return groups;
}

std::uint64_t journal_at(const Header& header, std::uint32_t index) {
  return header.journals_at + index * journal_stride(header);
}

void fill(std::byte* base, const Header& header, const memmap::Map& map,
          const std::string& map_text) {
  std::memcpy(base, &header, sizeof header);
  auto* slots = reinterpret_cast<Slot*>(base + sizeof(Header));
  std::memset(slots, 0, kMaxSlots * sizeof(Slot));
  slots[0] = {header.creator, kCreator, 0, 0, 0};
  fill_groups(base, header, map);
  std::memcpy(base + header.map_text_at, map_text.data(), map_text.size());
  auto* words = reinterpret_cast<std::uint32_t*>(base + header.memory_at);
  for (const auto& entry : map.signals()) {
    const memmap::Codec codec{*entry.signal};
    words[entry.signal->offset.value()] = codec.encode(codec.to_si(entry.signal->initial));
  }
}

}  // namespace rths::broker
