// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/ring.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "segment.hpp"

namespace rths::broker {
namespace {

// @returns false if there is no ring of this name
// @throws Error if it may not be replaced
bool is_abandoned(const std::string& name) {
  const auto report = inspect_ring(name);
  if (!report) return false;
  if (report->foreign) throw Error{report->trouble + "; choose another name"};
  std::string pids;
  for (const auto& occupant : report->occupants)
    if (occupant.alive) pids += fmt::format(" {} ({})", occupant.node, occupant.process);
  if (report->is_of_cards())
    throw Error{fmt::format(
        "ring '{}' exists already, made by programs written for the cards{}{}; remove it by "
        "'rths clean {}' and start the run before them",
        name, pids.empty() ? "" : "; end", pids, name)};
  if (report->in_use())
    throw Error{fmt::format("ring '{}' is in use by{}; choose another name", name, pids)};
  return true;
}

// Other processes may join or replace the ring meanwhile. The second look is at the object that is
// removed, and while no process can join it.
void remove_if_abandoned(const std::string& name) {
  if (!is_abandoned(name)) return;
  const auto object = SharedObject::open_to_remove(name);
  if (!object)
    throw Error{
        fmt::format("another process is using or replacing ring '{}'; choose another name", name)};
  if (is_abandoned(name)) remove_ring(name);
}

}  // namespace

Ring::Ring(std::unique_ptr<Segment> segment)
    : segment_{std::move(segment)}, map_{&segment_->map()} {}

Ring::Ring(Ring&&) noexcept = default;
Ring& Ring::operator=(Ring&&) noexcept = default;
Ring::~Ring() = default;

Ring Ring::create(const std::string& name, const memmap::Map& map, std::uint32_t journal_bits) {
  remove_if_abandoned(name);
  return create_new(name, map, journal_bits);
}

Ring Ring::create_new(const std::string& name, const memmap::Map& map, std::uint32_t journal_bits) {
  return Ring{Segment::create_shared(name, map, journal_bits)};
}

Ring Ring::attach(const std::string& name) { return Ring{Segment::attach_shared(name)}; }

Ring Ring::look_at(const std::string& name) {
  return Ring{Segment::attach_shared(name, ObjectAccess::ReadOnly)};
}

bool Ring::is_current() const { return segment_->has_name(); }

void Ring::check_writable() const {
  if (segment_->is_read_only())
    throw Error{"this is a look at the ring, expected one that is attached"};
}

Ring Ring::in_process(const memmap::Map& map, std::uint32_t journal_bits) {
  return Ring{Segment::create_in_process(map, journal_bits)};
}

const memmap::Map& Ring::map() const { return *map_; }

Node Ring::join(const std::string& node, std::uint64_t map_hash) {
  check_writable();
  const std::uint64_t ring_hash = segment_->layout().map_hash;
  if (map_hash != 0 && map_hash != ring_hash)
    throw Error{fmt::format("node '{}' was built for map {}, the ring has map '{}' {}", node,
                            memmap::hash_text(map_hash), map_->description().name,
                            memmap::hash_text(ring_hash))};
  return Node{*segment_, *map_, map_->node(node)};
}

Node Ring::join_plain(const std::string& node) {
  check_writable();
  const auto id = node.empty() ? std::nullopt : std::optional{map_->node(node)};
  return Node{*segment_, *map_, id, true};
}

Node Ring::observe() { return Node{*segment_, *map_, std::nullopt}; }

TearGroupId Ring::tear_group(const std::string& partition) const {
  std::uint32_t index = 0;
  for (const auto& candidate : map_->partitions()) {
    if (candidate.tear_group && candidate.name == partition) return TearGroupId{index};
    index += candidate.tear_group ? 1 : 0;
  }
  throw Error{fmt::format("partition '{}' of map '{}' is not a tear group", partition,
                          map_->description().name)};
}

}  // namespace rths::broker
