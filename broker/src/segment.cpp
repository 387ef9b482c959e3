// SPDX-License-Identifier: Apache-2.0
#include "segment.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <sys/mman.h>

#include <rths/broker/detail/card_layout.hpp>
#include <rths/core/config.hpp>
#include <rths/core/text.hpp>

namespace rths::broker {
namespace {

// A memory larger than any SCRAMNet+ card's stays sparse: no program uses all 128 MB of a GT card.
std::uint64_t reserved_bytes(const Header& header) {
  return header.memory_bytes > kLargestPlusMemory ? header.memory_at : common_bytes(header);
}

// Maps reserved pages now, so that no real-time write is the first touch of a page. A kernel that
// does not support it does nothing.
void populate_pages(const Mapping& mapping, std::uint64_t bytes) {
  madvise(mapping.address(), bytes, MADV_POPULATE_WRITE);
}

Header checked_header(const SharedObject& object, const std::string& name) {
  Header header{};
  const std::uint64_t size = object.size();
  if (!object.read(0, &header, sizeof header) || header.magic != kMagic)
    throw Error{"it is not an rths ring"};
  if (header.layout_version != kLayoutVersion)
    throw ForeignRing{
        fmt::format("ring '{}' cannot be used: its layout is version {}, this program's is {}",
                    name, header.layout_version, kLayoutVersion)};
  if (total_bytes(header) != size)
    throw Error{
        fmt::format("its size is {} bytes, its header expects {}", size, total_bytes(header))};
  if (header.map_text_bytes > kMostMapText) throw Error{"its header is damaged"};
  return header;
}

// The map determines the layout, so that every offset, size and count of the header is compared.
memmap::Map checked_map(const SharedObject& object, const Header& header) {
  std::string text(header.map_text_bytes, '\0');
  if (!object.read(header.map_text_at, text.data(), text.size()))
    throw Error{"its header is damaged"};
  auto map = memmap::parse_map(text, "the map in the ring");
  if (map.to_toml() != text) throw Error{"the map in the ring is not in its canonical form"};
  const Header expected = plan_layout(map, text, static_cast<std::uint32_t>(header.journal_bits));
  if (!is_same_layout(header, expected))
    throw Error{"the map in the ring does not match the ring's header"};
  return map;
}

bool is_same_entry(const Group& a, const Group& b) {
  return a.base == b.base && a.longwords == b.longwords && a.journal == b.journal &&
         a.record_at == b.record_at;
}

void check_groups(const SharedObject& object, const Header& header, const memmap::Map& map) {
  const std::vector<Group> expected = plan_groups(map);
  std::vector<Group> found(expected.size());
  if (!object.read(header.groups_at, found.data(), found.size() * sizeof(Group)) ||
      !std::equal(found.begin(), found.end(), expected.begin(), is_same_entry))
    throw Error{"its table of tear groups does not match its map"};
}

}  // namespace

struct HeapDeleter {
  void operator()(std::byte* bytes) const {
    ::operator delete[](bytes, std::align_val_t{kPageBytes});
  }
};
using Heap = std::unique_ptr<std::byte[], HeapDeleter>;

static Heap zeroed_heap(std::uint64_t bytes) {
  Heap heap{static_cast<std::byte*>(::operator new[](bytes, std::align_val_t{kPageBytes}))};
  std::memset(heap.get(), 0, bytes);
  return heap;
}

// Either a shared object or private memory of this process.
struct Segment::Memory {
  std::optional<SharedObject> object;
  ObjectAccess access = ObjectAccess::ReadWrite;
  Mapping common;
  std::vector<Mapping> journals;
  std::string name;  ///< of a shared object
  Heap heap;
  std::vector<Heap> journal_heaps;

  [[nodiscard]] std::byte* base() const { return object ? common.address() : heap.get(); }
  std::byte* journal(std::uint32_t index, std::uint64_t begin, std::uint64_t bytes) {
    if (!object) {
      if (!journal_heaps[index]) journal_heaps[index] = zeroed_heap(bytes);
      return journal_heaps[index].get();
    }
    if (journals[index].address() == nullptr) {
      if (access == ObjectAccess::ReadWrite) object->reserve(begin, bytes);
      journals[index] = object->map(begin, bytes);
      if (access == ObjectAccess::ReadWrite) populate_pages(journals[index], bytes);
    }
    return journals[index].address();
  }
};

Segment::Segment(std::unique_ptr<Memory> memory, const Header& layout, memmap::Map map)
    : memory_{std::move(memory)}, base_{memory_->base()}, layout_{layout}, map_{std::move(map)} {
  memory_->journals.resize(layout_.journal_count);
  memory_->journal_heaps.resize(layout_.journal_count);
  auto* entry = at<Group>(layout_.groups_at);
  for (const Group& group : plan_groups(map_))
    groups_.push_back({group.base, group.longwords, group.journal,
                       at<std::uint32_t>(layout_.records_at + group.record_at),
                       words() + group.base, &entry++->journalled});
}

Segment::~Segment() {
  Claim creator = layout_.creator;
  if (creator_ && creator == own_claim())  // not in a forked child
    std::atomic_ref{slots()[0].claim}.compare_exchange_strong(creator, 0);
}

void Segment::populate() {
  if (!memory_->object || populated_ || is_read_only()) return;
  populate_pages(memory_->common, reserved_bytes(layout_));
  populated_ = true;
}

Slot* Segment::slot_of(NodeId node) noexcept {
  for (Slot& slot : slots())
    if (std::atomic_ref{slot.claim}.load(std::memory_order_acquire) != 0 &&
        std::atomic_ref{slot.node}.load(std::memory_order_acquire) == node.value())
      return &slot;
  return nullptr;
}

bool Segment::is_member(Claim claim) const {
  return memory_->object ? memory_->object->members().has(claim) : claim == own_claim();
}

bool Segment::is_read_only() const { return memory_->access == ObjectAccess::ReadOnly; }

const std::string& Segment::name() const { return memory_->name; }

bool Segment::has_name() const {
  return !memory_->object || memory_->object->has_name(memory_->name);
}

std::unique_ptr<Membership> Segment::enter() const {
  if (!memory_->object || is_read_only()) return nullptr;
  try {
    auto membership = memory_->object->enter();
    if (!memory_->object->has_name(memory_->name)) throw Error{"it was removed"};
    return membership;
  } catch (const Error& error) {
    throw Error{fmt::format("ring '{}' cannot be joined: {}", memory_->name, error.what())};
  }
}

bool Segment::is_lost() const noexcept {
  auto& magic = reinterpret_cast<Header*>(base_)->magic;
  return std::atomic_ref{magic}.load(std::memory_order_relaxed) != kMagic ||
         (memory_->object && memory_->object->lost().load(std::memory_order_relaxed));
}

JournalView Segment::journal(std::uint32_t index) {
  const auto bits = static_cast<std::uint32_t>(layout_.journal_bits);
  std::byte* begin = memory_->journal(index, journal_at(layout_, index), journal_bytes(bits));
  return {reinterpret_cast<JournalHead*>(begin),
          reinterpret_cast<JournalEntry*>(begin + sizeof(JournalHead)), bits};
}

std::unique_ptr<Segment> Segment::create_shared(const std::string& name, const memmap::Map& map,
                                                std::uint32_t journal_bits) {
  check_ring_name(name);
  const std::string text = map.to_toml();
  Header header = plan_layout(map, text, journal_bits);
  header.creator = own_claim();
  auto memory = std::make_unique<Memory>();
  memory->name = name;
  try {
    const SharedObject& object = memory->object.emplace(SharedObject::create(total_bytes(header)));
    object.reserve(0, reserved_bytes(header));
    memory->common = object.map(0, common_bytes(header));
    fill(memory->base(), header, map, text);
    auto creator = object.enter();
    object.publish(name);
    std::unique_ptr<Segment> segment{new Segment{std::move(memory), header, map}};
    segment->creator_ = std::move(creator);
    return segment;
  } catch (const std::exception& error) {
    throw Error{fmt::format("ring '{}' ({} bytes of shared memory) cannot be created: {}", name,
                            common_bytes(header), error.what())};
  }
}

std::unique_ptr<Segment> Segment::attach_shared(const std::string& name, ObjectAccess access) {
  auto memory = std::make_unique<Memory>();
  memory->name = name;
  memory->access = access;
  try {
    memory->object.emplace(SharedObject::open(name, access));
  } catch (const Error& error) {
    const auto rings = ring_names();
    if (!contains(rings, name))
      throw ForeignRing{fmt::format(
          "there is no ring '{}'{}; start its run before the programs on it", name,
          rings.empty() ? " on this host, nor any other" : did_you_mean_one_of(name, rings))};
    throw ForeignRing{fmt::format("ring '{}' cannot be attached: {}", name, error.what())};
  }
  try {
    const Header header = checked_header(*memory->object, name);
    memmap::Map map = checked_map(*memory->object, header);
    check_groups(*memory->object, header, map);
    memory->common = memory->object->map(0, common_bytes(header));
    return std::unique_ptr<Segment>{new Segment{std::move(memory), header, std::move(map)}};
  } catch (const ForeignRing&) {
    throw;
  } catch (const Error& error) {
    throw Error{fmt::format("ring '{}' cannot be used: {}", name, error.what())};
  }
}

std::unique_ptr<Segment> Segment::create_in_process(const memmap::Map& map,
                                                    std::uint32_t journal_bits) {
  const std::string text = map.to_toml();
  Header header = plan_layout(map, text, journal_bits);
  header.creator = own_claim();
  auto memory = std::make_unique<Memory>();
  memory->heap = zeroed_heap(common_bytes(header));
  fill(memory->base(), header, map, text);
  return std::unique_ptr<Segment>{new Segment{std::move(memory), header, map}};
}

}  // namespace rths::broker
