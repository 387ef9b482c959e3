// SPDX-License-Identifier: Apache-2.0
#include "layout.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include <rths/memmap/codec.hpp>

#include "card_layout.hpp"
#include "journal.hpp"
#include "process.hpp"
#include "record.hpp"

namespace rths::broker {
namespace {

constexpr std::uint64_t kMostBytes = 256U << 20U;  // of any section: twice the largest memory
constexpr std::uint32_t kFewestBits = 6;
constexpr std::uint32_t kMostBits = 24;
constexpr std::uint64_t kGroupsAt = kWakeAt + sizeof(Wake);
static_assert(kGroupsAt % alignof(Group) == 0);

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t to) {
  return (value + to - 1) / to * to;
}

std::uint64_t records_end(const Header& h) { return h.records_at + h.records_bytes; }

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
  auto* group = reinterpret_cast<Group*>(base + header.groups_at);
  std::uint32_t record_at = 0;
  for (const auto& partition : map.partitions()) {
    if (!partition.tear_group) continue;
    *group++ = {partition.base.value(), partition.longwords,
                node_index(map, map.node(partition.node)), record_at, 0};
    disable_record(reinterpret_cast<std::uint32_t*>(base + header.records_at + record_at));
    record_at += static_cast<std::uint32_t>(record_bytes(partition.longwords));
  }
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
  header.creator = own_claim();
  header.map_hash = map.hash();
  header.groups_at = kGroupsAt;
  for (const auto& partition : map.partitions()) {
    if (!partition.tear_group) continue;
    ++header.group_count;
    header.records_bytes += record_bytes(partition.longwords);
  }
  header.records_at = round_up(kGroupsAt + header.group_count * sizeof(Group), kPairBytes);
  header.map_text_at = records_end(header);
  header.map_text_bytes = map_text.size();
  header.memory_at = round_up(header.map_text_at + header.map_text_bytes, kPageBytes);
  header.memory_bytes = std::uint64_t{map.description().size_longwords} * 4;
  header.journals_at = header.memory_at + header.memory_bytes;
  header.journal_bits = enough_bits(map, journal_bits);
  header.journal_count = map.description().nodes.size();
  header.cards_at = journal_at(header, static_cast<std::uint32_t>(header.journal_count));
  header.card_bytes = card_size(header.memory_bytes);
  header.card_count = kMaxSlots;
  return header;
}

std::uint64_t total_bytes(const Header& header) {
  return header.cards_at + header.card_count * header.card_bytes;
}

std::uint64_t common_bytes(const Header& header) { return header.journals_at; }

bool layout_is_valid(const Header& h) {
  for (const std::uint64_t size : {h.group_count, h.group_count * sizeof(Group), h.records_bytes,
                                   h.map_text_bytes, h.memory_bytes, h.journal_count})
    if (size > kMostBytes) return false;
  return h.groups_at == kGroupsAt &&
         h.records_at == round_up(kGroupsAt + h.group_count * sizeof(Group), kPairBytes) &&
         h.map_text_at == records_end(h) &&
         h.memory_at == round_up(h.map_text_at + h.map_text_bytes, kPageBytes) &&
         h.journals_at == h.memory_at + h.memory_bytes && h.journal_bits >= kFewestBits &&
         h.journal_bits <= kMostBits &&
         h.cards_at == journal_at(h, static_cast<std::uint32_t>(h.journal_count)) &&
         h.card_bytes == card_size(h.memory_bytes) && h.card_count == kMaxSlots;
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
  std::atomic_ref{reinterpret_cast<Header*>(base)->ready}.store(kReady, std::memory_order_release);
}

}  // namespace rths::broker
