// SPDX-License-Identifier: Apache-2.0
#include <pwd.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <bit>

#include <fmt/format.h>

#include <rths/broker/detail/process.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "record.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

void describe_occupants(Segment& segment, const memmap::Map& map, RingReport& report) {
  for (Slot& slot : segment.slots()) {
    const Claim claim = std::atomic_ref{slot.claim}.load();
    if (claim == 0) continue;
    const std::uint32_t node = std::atomic_ref{slot.node}.load();
    const bool plain = std::atomic_ref{slot.plain}.load() != 0;
    const std::string name = node == kObserver  ? (plain ? "client" : "observer")
                             : node == kCreator ? "creator"
                             : node == kNotYet  ? "joining"
                                               : map.node_name(NodeId{static_cast<uint16_t>(node)});
    report.occupants.push_back({name, pid_of(claim), in_words(claim), is_of_this_namespace(claim),
                                segment.is_member(claim), plain,
                                std::atomic_ref{slot.beats}.load()});
  }
}

void describe_groups(Segment& segment, const memmap::Map& map, RingReport& report) {
  for (const GroupView& group : segment.groups())
    if (is_torn(group.record, group.longwords))
      report.torn_groups.push_back(map.partition_at(LongwordOffset{group.base})->name);
}

// The owner of the object, if it is neither this user nor root; empty otherwise.
std::string other_user_of(const struct stat& object) {
  if (object.st_uid == geteuid() || object.st_uid == 0) return "";
  const passwd* user = getpwuid(object.st_uid);
  return user != nullptr ? user->pw_name : std::to_string(object.st_uid);
}

void describe_segment(Segment& segment, RingReport& report) {
  const memmap::Map& map = segment.map();
  report.bytes = common_bytes(segment.layout());
  report.map_name = map.description().name;
  report.map_version = map.description().version;
  report.map_hash = memmap::hash_text(map.hash());
  const std::uint64_t cards = std::atomic_ref{segment.header().cards_in_use}.load();
  report.cards = static_cast<std::uint32_t>(std::popcount(cards));
  describe_occupants(segment, map, report);
  describe_groups(segment, map, report);
  report.usable = true;
}

std::optional<RingReport> inspect(const std::string& name) {
  struct stat object {};
  if (lstat(object_path(name).c_str(), &object) != 0) return std::nullopt;
  RingReport report;
  report.name = name;
  report.bytes = static_cast<std::uint64_t>(object.st_size);
  report.other_user = other_user_of(object);
  try {
    if (!report.other_user.empty())
      throw ForeignRing{fmt::format("ring '{}' belongs to user {}", name, report.other_user)};
    describe_segment(*Segment::attach_shared(report.name), report);
  } catch (const ForeignRing& error) {
    report.foreign = true;
    report.trouble = error.what();
  } catch (const Error& error) {
    report.trouble = error.what();
  }
  return report;
}

}  // namespace

RingReport Ring::report() {
  RingReport report;
  report.name = segment_->name();
  describe_segment(*segment_, report);
  return report;
}

std::vector<RingReport> list_rings() {
  std::vector<RingReport> reports;
  for (const auto& name : ring_names())
    if (auto report = inspect(name)) reports.push_back(std::move(*report));
  return reports;
}

std::optional<RingReport> inspect_ring(const std::string& name) { return inspect(name); }

bool remove_ring(const std::string& name) { return remove_object(name); }

bool remove_unused_ring(const std::string& name) {
  const auto object = SharedObject::open_to_remove(name);
  return object && remove_object(name);
}

}  // namespace rths::broker
