// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/map.hpp>

namespace rths::python {

class Follower;
class Member;

/// A ring, and the codecs of its signals. Nodes, followers and views share it: Python frees objects
/// in any order, and the ring's memory stays mapped until the last of them is freed.
class RingHandle : public std::enable_shared_from_this<RingHandle> {
 public:
  explicit RingHandle(broker::Ring ring);

  /// @param map_file  a map file   @throws Error as broker::Ring::create
  [[nodiscard]] static std::shared_ptr<RingHandle> create(const std::string& name,
                                                          const std::string& map_file);
  [[nodiscard]] static std::shared_ptr<RingHandle> attach(const std::string& name);
  [[nodiscard]] static std::shared_ptr<RingHandle> in_process(const std::string& map_file);

  [[nodiscard]] std::unique_ptr<Member> join(const std::string& node, bool plain);
  [[nodiscard]] std::unique_ptr<Member> observe();
  [[nodiscard]] std::unique_ptr<Follower> follow(const std::vector<std::string>& signals);

  [[nodiscard]] broker::Ring& ring() { return ring_; }
  [[nodiscard]] const memmap::Map& map() const { return ring_.map(); }
  /// @throws Error with the most similar known name
  [[nodiscard]] const memmap::SignalEntry& entry(const std::string& signal) const;
  [[nodiscard]] const memmap::Partition& partition(const std::string& name) const;
  /// The codec of a signal, made once: reading a unit takes longer than a word.
  [[nodiscard]] const memmap::Codec& codec(const memmap::SignalEntry& entry);

 private:
  broker::Ring ring_;
  std::vector<std::optional<memmap::Codec>> codecs_;  ///< in the order of the map's signals
};

}  // namespace rths::python
