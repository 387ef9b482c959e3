// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <atomic>
#include <bit>
#include <filesystem>

#include <boost/interprocess/shared_memory_object.hpp>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "process.hpp"
#include "record.hpp"
#include "segment.hpp"

namespace rths::broker {
namespace {

constexpr const char* kObjectFolder = "/dev/shm";
constexpr auto kInventoryTimeout = std::chrono::milliseconds{100};  // for a ring in creation

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
    report.occupants.push_back(
        {name, pid_of(claim), is_alive(claim), plain, std::atomic_ref{slot.beats}.load()});
  }
}

void describe_groups(Segment& segment, const memmap::Map& map, RingReport& report) {
  const Group* group = segment.groups();
  for (const auto& partition : map.partitions()) {
    if (!partition.tear_group) continue;
    if (is_torn(segment.record(*group), group->longwords))
      report.torn_groups.push_back(partition.name);
    ++group;
  }
}

RingReport inspect(const std::string& name, std::uint64_t bytes) {
  RingReport report;
  report.name = name;
  report.bytes = bytes;
  try {
    const auto segment = Segment::attach_shared(name, kInventoryTimeout);
    const memmap::Map map = segment->map();
    report.bytes = segment->header().memory_at + segment->header().memory_bytes;
    report.map_name = map.description().name;
    report.map_version = map.description().version;
    report.map_hash = memmap::hash_text(map.hash());
    const std::uint64_t cards = std::atomic_ref{segment->header().cards_in_use}.load();
    report.cards = static_cast<std::uint32_t>(std::popcount(cards));
    describe_occupants(*segment, map, report);
    describe_groups(*segment, map, report);
    report.usable = true;
  } catch (const ForeignRing& error) {
    report.foreign = true;
    report.trouble = error.what();
  } catch (const Error& error) {
    report.trouble = error.what();
  }
  return report;
}

}  // namespace

std::vector<RingReport> list_rings() {
  const std::string prefix = object_name("");
  std::vector<RingReport> reports;
  std::error_code unreadable;
  for (const auto& file : std::filesystem::directory_iterator{kObjectFolder, unreadable}) {
    const std::string object = file.path().filename().string();
    if (object.rfind(prefix, 0) != 0) continue;
    reports.push_back(inspect(object.substr(prefix.size()), file.file_size(unreadable)));
  }
  std::sort(reports.begin(), reports.end(),
            [](const RingReport& a, const RingReport& b) { return a.name < b.name; });
  return reports;
}

std::optional<RingReport> inspect_ring(const std::string& name) {
  const auto file = std::filesystem::path{kObjectFolder} / object_name(name);
  std::error_code missing;
  const auto bytes = std::filesystem::file_size(file, missing);
  if (missing) return std::nullopt;
  return inspect(name, bytes);
}

bool remove_ring(const std::string& name) {
  return boost::interprocess::shared_memory_object::remove(object_name(name).c_str());
}

}  // namespace rths::broker
