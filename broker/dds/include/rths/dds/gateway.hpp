// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/dds/carrier.hpp>

namespace rths::dds {

/// Counts of a gateway since its start.
struct GatewayCounts {
  std::uint64_t frames_sent = 0, updates_sent = 0;
  std::uint64_t frames_received = 0, updates_received = 0;  ///< applied to the ring
  std::uint64_t bad_frames = 0;       ///< not frames, of another map, or with words of other nodes
  std::uint64_t repeated = 0;         ///< updates received more than once
  std::uint64_t gaps = 0;             ///< missing updates that were asked for again
  std::uint64_t sent_again = 0;       ///< frames sent again
  std::uint64_t snapshots = 0;        ///< received
  std::uint64_t mismatches = 0;       ///< digests that differed
  std::uint64_t lapped = 0;           ///< local writes that the journal lost before they were sent
  std::uint64_t interrupts_sent = 0;  ///< of GT cards
  std::uint64_t interrupts_lost = 0;  ///< overwritten before, or from a card without a node
  std::uint64_t hold_off_ns = 0;      ///< time during which sending blocked
  std::uint64_t rejoins = 0;          ///< times it joined the network anew, as a host was silent
};

/// Another host, as its announcements show it.
struct RemoteHost {
  /// Estimate from the times of messages in both directions.
  struct ClockDifference {
    Duration offset{0};  ///< its CLOCK_MONOTONIC minus ours
    Duration error{0};   ///< the true offset differs by at most this
  };
  std::string name;
  Duration silence{0};                   ///< since its last announcement
  std::optional<ClockDifference> clock;  ///< empty before the first exchange
  Duration real_time_ahead{0};           ///< its CLOCK_REALTIME minus ours, if `clock` is known
};

/// A node of another host.
struct RemoteNode {
  std::string node, host;
  Duration age{0};    ///< its words are here as they were there this long ago
  Duration delay{0};  ///< of its last updates, from sending to this ring
};

/// The other hosts and their nodes, at most 10 ms old.
struct GatewayStatus {
  std::vector<RemoteHost> hosts;
  std::vector<RemoteNode> nodes;
};

struct GatewayOptions {
  std::string host;                                ///< name of this host, in messages
  std::function<void(const std::string&)> report;  ///< one line per event; from both threads
  bool skips_unchanged = false;  ///< does not send writes that leave a word as it was
  /// For virtual time: sends every write, also of `latest` partitions, and writes no signals.
  bool is_deterministic = false;
  /// Called once by each thread that carries updates, when it begins, such as to set its priority.
  std::function<void()> prepare_thread = {};  // NOLINT(readability-redundant-member-init)
};

/// Makes the rings of several hosts one: sends the writes of the nodes on this host to the others,
/// and writes those of their nodes into this ring, as the only local writer of their words.
///
/// A node that joins here belongs to this host. A node that another host announces is joined here
/// on its behalf until it leaves there. Writes of one node arrive once, whole, and in its order.
/// Three threads, begun and ended with this object; not for real-time threads.
class Gateway {
 public:
  /// @param ring  name of a ring of this host
  /// @throws Error if there is no such ring   @setup
  Gateway(const std::string& ring, std::unique_ptr<Carrier> carrier, GatewayOptions options);
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  [[nodiscard]] GatewayCounts counts() const;
  [[nodiscard]] GatewayStatus status() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::dds
