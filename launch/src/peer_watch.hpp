// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/launch/run.hpp>

#include "silence.hpp"

namespace rths::launch {

/// Detects vanished and silent nodes of a run. A node has vanished when the kernel reports the end
/// of its process. It is silent when its heartbeats stop while those of the watching node continue.
class PeerWatch {
 public:
  /// Watches all nodes of the experiment except its own. Others may join to observe or to tune.
  PeerWatch(const broker::Node& node, const memmap::Map& map, const Experiment& experiment,
            const std::string& own_name);

  /// Call it every few hundredths of a second. @returns the loss of the ring, or the trouble of the
  /// first such peer
  [[nodiscard]] std::optional<std::string> find_trouble(TimePoint now);
  [[nodiscard]] bool is_ring_lost() const { return node_.is_ring_lost(); }

 private:
  struct Peer {
    std::string name;
    NodeId id;
    Duration longest_silence;
    bool is_foreign;  ///< a program of the user's own, which may have no heartbeat
    Silence silence;
  };
  const broker::Node& node_;
  NodeId own_;
  bool has_images_;  ///< of a ring of cards, which carries heartbeats by messages
  std::uint64_t own_beats_ = 0;
  std::vector<Peer> peers_;
};

}  // namespace rths::launch
