// SPDX-License-Identifier: Apache-2.0
#include "segment.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>
#include <thread>
#include <utility>
#include <variant>

#include <fcntl.h>

#include <fmt/format.h>
#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>

#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/map.hpp>

#include "card_room.hpp"
#include "process.hpp"

namespace rths::broker {
namespace {

namespace ipc = boost::interprocess;
using std::chrono::steady_clock;

constexpr std::uint64_t kMostBytes = 256U << 20U;  // of any part: twice the largest memory
constexpr auto kReadyPoll = std::chrono::milliseconds{1};

constexpr std::uint64_t round_up(std::uint64_t value, std::uint64_t to) {
  return (value + to - 1) / to * to;
}

Header plan_layout(const memmap::Map& map, const std::string& map_text) {
  Header header{};
  header.magic = kMagic;
  header.layout_version = kLayoutVersion;
  header.creator = own_claim();
  header.map_hash = map.hash();
  header.groups_at = sizeof(Header) + kMaxSlots * sizeof(Slot);
  header.group_count = static_cast<std::uint64_t>(
      std::count_if(map.partitions().begin(), map.partitions().end(),
                    [](const auto& partition) { return partition.tear_group; }));
  header.map_text_at = header.groups_at + header.group_count * sizeof(Group);
  header.map_text_bytes = map_text.size();
  header.memory_at = round_up(header.map_text_at + header.map_text_bytes, kPageBytes);
  header.memory_bytes = std::uint64_t{map.description().size_longwords} * 4;
  return header;
}

// What every node maps.
std::uint64_t total_bytes(const Header& header) { return header.memory_at + header.memory_bytes; }

std::uint64_t object_bytes(const Header& header) {
  return header.card_count == 0 ? total_bytes(header)
                                : header.cards_at + header.card_count * header.card_bytes;
}

void plan_cards(Header& header) {
  header.cards_at = round_up(total_bytes(header), kPageBytes);
  header.card_bytes = card_room(header.memory_bytes);
  header.card_count = kMaxSlots;
}

// `ready` is published last, so whoever sees it sees all the rest.
void fill(std::byte* base, Header header, const memmap::Map& map, const std::string& map_text) {
  std::memcpy(base, &header, sizeof header);
  auto* slots = reinterpret_cast<Slot*>(base + sizeof(Header));
  std::memset(slots, 0, kMaxSlots * sizeof(Slot));
  slots[0] = {header.creator, kCreator, 0, 0};
  auto* group = reinterpret_cast<Group*>(base + header.groups_at);
  for (const auto& partition : map.partitions())
    if (partition.tear_group) *group++ = {0, partition.base.value(), partition.longwords};
  std::memcpy(base + header.map_text_at, map_text.data(), map_text.size());
  auto* words = reinterpret_cast<std::uint32_t*>(base + header.memory_at);
  for (const auto& entry : map.signals()) {
    const memmap::Codec codec{*entry.signal};
    words[entry.signal->offset.value()] = codec.encode(codec.to_si(entry.signal->initial));
  }
  std::atomic_ref{reinterpret_cast<Header*>(base)->ready}.store(kReady, std::memory_order_release);
}

// The parts lie one behind the other and end where the memory ends.
bool parts_are_in_order(const Header& h) {
  for (const std::uint64_t size : {h.group_count * sizeof(Group), h.map_text_bytes, h.memory_bytes})
    if (size > kMostBytes) return false;
  if (h.card_count != 0 &&
      (h.card_count > kMaxSlots || h.cards_at != round_up(total_bytes(h), kPageBytes) ||
       h.card_bytes != card_room(h.memory_bytes)))
    return false;
  return h.group_count <= kMostBytes && h.groups_at == sizeof(Header) + kMaxSlots * sizeof(Slot) &&
         h.map_text_at == h.groups_at + h.group_count * sizeof(Group) &&
         h.memory_at == round_up(h.map_text_at + h.map_text_bytes, kPageBytes);
}

// Anybody may have made an object of that name: nothing in it is believed before it is checked.
std::string trouble_with(const Header& header, std::uint64_t found_bytes) {
  if (header.magic != kMagic) return "it is no rths ring";
  if (!parts_are_in_order(header)) return "its header is damaged";
  if (object_bytes(header) != found_bytes)
    return fmt::format("it has {} bytes, its header says {}", found_bytes, object_bytes(header));
  return "";
}

bool object_has_header(const ipc::shared_memory_object& object) {
  ipc::offset_t size = 0;
  return object.get_size(size) && size >= static_cast<ipc::offset_t>(sizeof(Header));
}

// Between the object's birth and `ready` its creator is at work, or has died doing it.
bool becomes_ready(const ipc::shared_memory_object& object, std::chrono::milliseconds patience) {
  for (const auto deadline = steady_clock::now() + patience;;) {
    if (object_has_header(object)) {
      ipc::mapped_region region{object, ipc::read_write, 0, sizeof(Header)};
      auto& header = *static_cast<Header*>(region.get_address());
      if (std::atomic_ref{header.ready}.load(std::memory_order_acquire) == kReady) return true;
      if (header.creator != 0 && !is_alive(header.creator)) return false;
    }
    if (steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(kReadyPoll);
  }
}

// Room is taken now: a page that is not to be had would kill whoever touches it first. Only a
// memory larger than any SCRAMNet+ card's stays sparse: nobody uses all of a GT card's 128 MB.
void take_room(ipc::shared_memory_object& object, const Header& header) {
  const bool sparse = header.memory_bytes > kLargestPlusMemory;
  const std::uint64_t now = sparse ? header.memory_at : total_bytes(header);
  const int problem =
      posix_fallocate(object.get_mapping_handle().handle, 0, static_cast<off_t>(now));
  if (problem != 0) throw Error{std::strerror(problem)};
  object.truncate(static_cast<ipc::offset_t>(object_bytes(header)));
}

Header header_of(const ipc::shared_memory_object& object) {
  const ipc::mapped_region region{object, ipc::read_only, 0, sizeof(Header)};
  return *static_cast<const Header*>(region.get_address());
}

}  // namespace

struct Segment::Memory {
  struct HeapDeleter {
    void operator()(std::byte* bytes) const {
      ::operator delete[](bytes, std::align_val_t{kPageBytes});
    }
  };
  ipc::mapped_region shared;
  std::unique_ptr<std::byte[], HeapDeleter> heap;

  [[nodiscard]] std::byte* base() const {
    return heap ? heap.get() : static_cast<std::byte*>(shared.get_address());
  }
};

Segment::Segment(std::unique_ptr<Memory> memory, bool created)
    : memory_{std::move(memory)}, base_{memory_->base()}, created_{created} {}

Segment::~Segment() {
  if (created_) std::atomic_ref{slots()[0].claim}.store(0);
}

memmap::Map Segment::map() {
  const Header& h = header();
  auto map = memmap::parse_map({at<char>(h.map_text_at), h.map_text_bytes}, "the map in the ring");
  const Header expected = plan_layout(map, map.to_toml());
  if (h.memory_bytes != expected.memory_bytes || h.group_count != expected.group_count ||
      h.map_hash != expected.map_hash)
    throw Error{"the map in the ring is not the one that the ring was made from"};
  return map;
}

std::string object_name(const std::string& ring) { return "rths." + ring; }

std::unique_ptr<Segment> Segment::create_shared(const std::string& name, const memmap::Map& map) {
  const std::string text = map.to_toml();
  Header header = plan_layout(map, text);
  plan_cards(header);
  auto memory = std::make_unique<Memory>();
  bool made = false;
  try {
    ipc::permissions permissions;
    permissions.set_permissions(0660);
    ipc::shared_memory_object object{ipc::create_only, object_name(name).c_str(), ipc::read_write,
                                     permissions};
    made = true;
    take_room(object, header);
    memory->shared = ipc::mapped_region{object, ipc::read_write, 0, total_bytes(header)};
  } catch (const std::exception& error) {
    if (made) ipc::shared_memory_object::remove(object_name(name).c_str());
    throw Error{fmt::format("ring '{}' ({} bytes of shared memory) cannot be created: {}", name,
                            total_bytes(header), error.what())};
  }
  fill(memory->base(), header, map, text);
  return std::unique_ptr<Segment>{new Segment{std::move(memory), true}};
}

std::unique_ptr<Segment> Segment::attach_shared(const std::string& name,
                                                std::chrono::milliseconds patience) {
  auto memory = std::make_unique<Memory>();
  try {
    const ipc::shared_memory_object object{ipc::open_only, object_name(name).c_str(),
                                           ipc::read_write};
    if (!becomes_ready(object, patience))
      throw Error{fmt::format(
          "ring '{}' was never finished by its creator; 'rths clean' removes it", name)};
    const Header header = header_of(object);
    if (header.magic == kMagic && header.layout_version != kLayoutVersion)
      throw ForeignRing{
          fmt::format("ring '{}' cannot be used: its layout is version {}, this program's is {}",
                      name, header.layout_version, kLayoutVersion)};
    ipc::offset_t size = 0;
    object.get_size(size);
    if (const std::string trouble = trouble_with(header, static_cast<std::uint64_t>(size));
        !trouble.empty())
      throw Error{fmt::format("ring '{}' cannot be used: {}", name, trouble)};
    memory->shared = ipc::mapped_region{object, ipc::read_write, 0, total_bytes(header)};
  } catch (const ipc::interprocess_exception& error) {
    throw ForeignRing{fmt::format("ring '{}' cannot be attached: {}", name, error.what())};
  }
  return std::unique_ptr<Segment>{new Segment{std::move(memory), false}};
}

std::unique_ptr<Segment> Segment::create_in_process(const memmap::Map& map) {
  const std::string text = map.to_toml();
  const Header header = plan_layout(map, text);
  auto memory = std::make_unique<Memory>();
  memory->heap.reset(
      static_cast<std::byte*>(::operator new[](total_bytes(header), std::align_val_t{kPageBytes})));
  std::memset(memory->base(), 0, total_bytes(header));
  fill(memory->base(), header, map, text);
  return std::unique_ptr<Segment>{new Segment{std::move(memory), true}};
}

}  // namespace rths::broker
