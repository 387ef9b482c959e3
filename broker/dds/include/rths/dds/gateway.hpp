// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include <rths/broker/ring.hpp>
#include <rths/dds/carrier.hpp>

namespace rths::dds {

/// Counts of a gateway since its start.
struct GatewayCounts {
  std::uint64_t frames_sent = 0, updates_sent = 0;
  std::uint64_t frames_received = 0, updates_received = 0;  ///< applied to the ring
  std::uint64_t bad_frames = 0;   ///< not frames, of another map, or with words of other nodes
  std::uint64_t repeated = 0;     ///< updates received more than once
  std::uint64_t gaps = 0;         ///< missing updates that were asked for again
  std::uint64_t sent_again = 0;   ///< frames sent again
  std::uint64_t snapshots = 0;    ///< received
  std::uint64_t mismatches = 0;   ///< digests that differed
  std::uint64_t lapped = 0;       ///< local writes that the journal lost before they were sent
  std::uint64_t hold_off_ns = 0;  ///< time during which sending blocked
};

struct GatewayOptions {
  std::string host;                                ///< name of this host, in messages
  std::function<void(const std::string&)> report;  ///< one line per event; from both threads
};

/// Makes the rings of several hosts one: sends the writes of the nodes on this host to the others,
/// and writes those of their nodes into this ring, as the only local writer of their words.
///
/// A node that joins here belongs to this host. A node that another host announces is joined here
/// on its behalf until it leaves there. Writes of one node arrive once, whole, and in its order.
/// Two threads, begun and ended with this object; not for real-time threads.
class Gateway {
 public:
  /// @param ring  name of a ring of this host
  /// @throws Error if there is no such ring   @setup
  Gateway(const std::string& ring, std::unique_ptr<Carrier> carrier, GatewayOptions options);
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  [[nodiscard]] GatewayCounts counts() const;
  /// Names of the hosts heard in the last second.
  [[nodiscard]] std::vector<std::string> hosts() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::dds
