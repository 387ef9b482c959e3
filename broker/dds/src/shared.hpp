// SPDX-License-Identifier: Apache-2.0
//
// Data that the two threads of a gateway share.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/core/clock.hpp>
#include <rths/dds/gateway.hpp>

#include "cards.hpp"
#include "frame.hpp"
#include "hello.hpp"

namespace rths::dds {

/// Updates that another host asks for; end 0: a snapshot.
struct Asked {
  HostId by = 0;
  std::uint16_t node = 0;
  std::uint64_t first = 0, end = 0;
};

/// Counts of both threads.
struct AtomicCounts {
  std::atomic<std::uint64_t> frames_sent{0}, updates_sent{0}, frames_received{0},
      updates_received{0}, bad_frames{0}, repeated{0}, gaps{0}, sent_again{0}, snapshots{0},
      mismatches{0}, lapped{0}, interrupts_sent{0}, interrupts_lost{0}, hold_off_ns{0}, rejoins{0};
};

/// When frames of another host arrived, and ours there. On the clock of this host.
struct Heard {
  TimePoint last{0};
  // Only of a host with our map, after its first announcement:
  TimePoint came{0};     ///< arrival of that
  TimePoint reached{0};  ///< when we sent the last announcement that it has confirmed
  std::string name;
};

struct Shared {
  HostId host = 0;
  std::uint64_t map_hash = 0;
  GatewayOptions options;
  Carrier* carrier = nullptr;
  const broker::Waiter* sender = nullptr;  ///< waits for local writes only
  const broker::Node* reader = nullptr;    ///< of this ring
  Cards* cards = nullptr;
  AtomicCounts counts;
  std::atomic<bool> ends{false};

  /// By NodeId: joined here on behalf of another host.
  std::vector<std::atomic<bool>> is_remote;

  std::mutex mutex;
  std::vector<Asked> asked;                     ///< by other hosts
  std::vector<std::vector<std::byte>> to_send;  ///< the receiver's requests
  std::vector<HelloEcho> echoes;                ///< of the other hosts' announcements
  std::vector<Received> received;               ///< of the other hosts' streams
  /// What a host has of the nodes here: all their writes before this number.
  using Confirmed = std::map<std::uint16_t, std::uint64_t>;
  std::map<HostId, Confirmed> confirmed;   ///< of all other hosts
  std::map<std::uint16_t, HostId> owners;  ///< of the nodes of other hosts
  TimePoint newest_host{0};                ///< when the last other host came
  std::map<HostId, Heard> heard;           ///< of all other hosts of late
  std::vector<Missed> missed;
  GatewayStatus status;

  void report(const std::string& line) const {
    if (options.report) options.report(line);
  }
};

}  // namespace rths::dds
