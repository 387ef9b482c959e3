// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>

#include "recorder.hpp"

namespace rths::testkit {

/// A ring of its own for the program of one node, and the threads that carry the writes between it
/// and the ring of the laboratory. The writes of the node can be dropped, delayed or damaged.
///
/// Both rings have all nodes: each thread joins as the nodes of the other side. A node that dies
/// stays on the other ring and is silent there.
class Link {
 public:
  /// @throws Error if the ring of the program exists
  Link(const std::string& ring, const memmap::Map& map, const std::string& node);
  ~Link();
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Name of the ring of the program.
  [[nodiscard]] const std::string& image() const { return image_; }
  /// Faults of the writes of the node.
  struct Faults {
    bool drops_all = false;
    std::set<std::uint32_t> dropped;               ///< offsets
    std::map<std::uint32_t, std::uint32_t> flips;  ///< inverted bits by offset
    Duration delay{0};
  };
  /// Changes the faults of the writes that follow.
  template <class Change>
  void change_faults(Change change) {
    const std::lock_guard lock{mutex_};
    change(faults_);
  }
  /// The first error of its threads; empty if none.
  [[nodiscard]] std::string trouble() const;
  /// Stores of the program into words of other nodes.
  [[nodiscard]] const ForeignLog& foreign_log() const { return foreign_log_; }

 private:
  struct Message {
    TimePoint due;
    std::uint32_t offset;
    bool is_group;
    std::vector<std::uint32_t> words;
  };
  class Double;
  class Outward;
  class Inward;
  template <class Direction>
  void carry();

  std::string ring_, image_, node_;
  const memmap::Map& map_;
  ForeignLog foreign_log_{map_, WallClock{}.now()};
  mutable std::mutex mutex_;  ///< of the next two
  Faults faults_;
  std::string trouble_;
  std::atomic<int> ready_{0};
  std::atomic<bool> ends_{false};
  std::vector<std::thread> threads_;
};

}  // namespace rths::testkit
