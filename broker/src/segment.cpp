// SPDX-License-Identifier: Apache-2.0
#include "segment.hpp"

#include <atomic>
#include <cstring>
#include <new>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>

#include <fmt/format.h>
#include <boost/interprocess/mapped_region.hpp>
#include <boost/interprocess/shared_memory_object.hpp>

#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "card_layout.hpp"
#include "process.hpp"

namespace rths::broker {
namespace {

namespace ipc = boost::interprocess;
using std::chrono::steady_clock;

constexpr auto kReadyPoll = std::chrono::milliseconds{1};

// Any program may have created an object of that name, so everything in it is checked before use.
std::string defect_of(const Header& header, std::uint64_t object_bytes) {
  if (header.magic != kMagic) return "it is not an rths ring";
  if (!layout_is_valid(header)) return "its header is damaged";
  if (total_bytes(header) != object_bytes)
    return fmt::format("its size is {} bytes, its header expects {}", object_bytes,
                       total_bytes(header));
  return "";
}

bool object_has_header(const ipc::shared_memory_object& object) {
  ipc::offset_t size = 0;
  return object.get_size(size) && size >= static_cast<ipc::offset_t>(sizeof(Header));
}

// Until `ready` is set, the creator is initialising the object, or has died doing so.
bool wait_until_ready(const ipc::shared_memory_object& object, std::chrono::milliseconds timeout) {
  for (const auto deadline = steady_clock::now() + timeout;;) {
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

// Reserves the pages now: a page that is missing later would kill the process that touches it.
void reserve_space(const ipc::shared_memory_object& object, std::uint64_t begin,
                   std::uint64_t bytes) {
  const int problem = posix_fallocate(object.get_mapping_handle().handle, static_cast<off_t>(begin),
                                      static_cast<off_t>(bytes));
  if (problem != 0) throw Error{std::strerror(problem)};
}

// A memory larger than any SCRAMNet+ card's stays sparse: no program uses all 128 MB of a GT card.
std::uint64_t reserved_bytes(const Header& header) {
  return header.memory_bytes > kLargestPlusMemory ? header.memory_at : common_bytes(header);
}

ipc::mapped_region map_range(const ipc::shared_memory_object& object, std::uint64_t begin,
                             std::uint64_t bytes) {
  return {object, ipc::read_write, static_cast<ipc::offset_t>(begin), bytes};
}

// Maps reserved pages now, so that no real-time write is the first touch of a page. A kernel that
// does not support it does nothing.
void populate_pages(const ipc::mapped_region& region, std::uint64_t bytes) {
  madvise(region.get_address(), bytes, MADV_POPULATE_WRITE);
}

std::uint64_t size_of(const ipc::shared_memory_object& object) {
  ipc::offset_t size = 0;
  return object.get_size(size) ? static_cast<std::uint64_t>(size) : 0;
}

// Reads and checks the header.
Header checked_header(const ipc::shared_memory_object& object, const std::string& name) {
  const ipc::mapped_region region = map_range(object, 0, sizeof(Header));
  const Header header = *static_cast<const Header*>(region.get_address());
  if (header.magic == kMagic && header.layout_version != kLayoutVersion)
    throw ForeignRing{
        fmt::format("ring '{}' cannot be used: its layout is version {}, this program's is {}",
                    name, header.layout_version, kLayoutVersion)};
  if (const std::string trouble = defect_of(header, size_of(object)); !trouble.empty())
    throw Error{fmt::format("ring '{}' cannot be used: {}", name, trouble)};
  return header;
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
  ipc::shared_memory_object object;
  ipc::mapped_region common;
  std::vector<ipc::mapped_region> journals;
  Heap heap;
  std::vector<Heap> journal_heaps;
  bool is_shared = false;

  [[nodiscard]] std::byte* base() const {
    return is_shared ? static_cast<std::byte*>(common.get_address()) : heap.get();
  }
  std::byte* journal(std::uint32_t index, std::uint64_t begin, std::uint64_t bytes) {
    if (!is_shared) {
      if (!journal_heaps[index]) journal_heaps[index] = zeroed_heap(bytes);
      return journal_heaps[index].get();
    }
    if (journals[index].get_size() == 0) {
      reserve_space(object, begin, bytes);
      journals[index] = map_range(object, begin, bytes);
      populate_pages(journals[index], bytes);
    }
    return static_cast<std::byte*>(journals[index].get_address());
  }
};

Segment::Segment(std::unique_ptr<Memory> memory, bool created)
    : memory_{std::move(memory)}, base_{memory_->base()}, created_{created} {
  memory_->journals.resize(header().journal_count);
  memory_->journal_heaps.resize(header().journal_count);
}

Segment::~Segment() {
  if (created_) std::atomic_ref{slots()[0].claim}.store(0);
}

void Segment::populate() {
  if (!memory_->is_shared || populated_) return;
  populate_pages(memory_->common, reserved_bytes(header()));
  populated_ = true;
}

Slot* Segment::slot_of(NodeId node) noexcept {
  for (Slot& slot : slots())
    if (std::atomic_ref{slot.claim}.load(std::memory_order_acquire) != 0 &&
        std::atomic_ref{slot.node}.load(std::memory_order_acquire) == node.value())
      return &slot;
  return nullptr;
}

JournalView Segment::journal(std::uint32_t index) {
  const auto bits = static_cast<std::uint32_t>(header().journal_bits);
  std::byte* begin = memory_->journal(index, journal_at(header(), index), journal_bytes(bits));
  return {reinterpret_cast<JournalHead*>(begin),
          reinterpret_cast<JournalEntry*>(begin + sizeof(JournalHead)), bits};
}

memmap::Map Segment::map() {
  const Header& h = header();
  auto map = memmap::parse_map({at<char>(h.map_text_at), h.map_text_bytes}, "the map in the ring");
  const Header expected =
      plan_layout(map, map.to_toml(), static_cast<std::uint32_t>(h.journal_bits));
  if (h.map_hash != expected.map_hash || total_bytes(h) != total_bytes(expected) ||
      h.group_count != expected.group_count || h.journal_count != expected.journal_count)
    throw Error{"the map in the ring does not match the ring's header"};
  return map;
}

std::string object_name(const std::string& ring) { return "rths." + ring; }

std::unique_ptr<Segment> Segment::create_shared(const std::string& name, const memmap::Map& map,
                                                std::uint32_t journal_bits) {
  const std::string text = map.to_toml();
  const Header header = plan_layout(map, text, journal_bits);
  auto memory = std::make_unique<Memory>();
  memory->is_shared = true;
  bool made = false;
  try {
    ipc::permissions permissions;
    permissions.set_permissions(0660);
    memory->object = ipc::shared_memory_object{ipc::create_only, object_name(name).c_str(),
                                               ipc::read_write, permissions};
    made = true;
    memory->object.truncate(static_cast<ipc::offset_t>(total_bytes(header)));
    reserve_space(memory->object, 0, reserved_bytes(header));
    memory->common = map_range(memory->object, 0, common_bytes(header));
  } catch (const std::exception& error) {
    if (made) ipc::shared_memory_object::remove(object_name(name).c_str());
    throw Error{fmt::format("ring '{}' ({} bytes of shared memory) cannot be created: {}", name,
                            common_bytes(header), error.what())};
  }
  fill(memory->base(), header, map, text);
  return std::unique_ptr<Segment>{new Segment{std::move(memory), true}};
}

std::unique_ptr<Segment> Segment::attach_shared(const std::string& name,
                                                std::chrono::milliseconds timeout) {
  auto memory = std::make_unique<Memory>();
  memory->is_shared = true;
  try {
    memory->object =
        ipc::shared_memory_object{ipc::open_only, object_name(name).c_str(), ipc::read_write};
    if (!wait_until_ready(memory->object, timeout))
      throw Error{
          fmt::format("ring '{}' was not completed by its creator; 'rths clean' removes it", name)};
    const Header header = checked_header(memory->object, name);
    memory->common = map_range(memory->object, 0, common_bytes(header));
  } catch (const ipc::interprocess_exception& error) {
    throw ForeignRing{fmt::format("ring '{}' cannot be attached: {}", name, error.what())};
  }
  return std::unique_ptr<Segment>{new Segment{std::move(memory), false}};
}

std::unique_ptr<Segment> Segment::create_in_process(const memmap::Map& map,
                                                    std::uint32_t journal_bits) {
  const std::string text = map.to_toml();
  const Header header = plan_layout(map, text, journal_bits);
  auto memory = std::make_unique<Memory>();
  memory->heap = zeroed_heap(common_bytes(header));
  fill(memory->base(), header, map, text);
  return std::unique_ptr<Segment>{new Segment{std::move(memory), true}};
}

}  // namespace rths::broker
