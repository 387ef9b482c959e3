// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <rths/broker/ring.hpp>

#include "ring_handle.hpp"

namespace rths::python {

/// A value to write: a number [SI], or the name of one of an integer's values.
using Value = std::variant<double, std::string>;

/// Membership of this program on a ring, as a node of the map or as an observer.
///
/// Python's global lock serialises the calls: none of them waits.
class Member {
 public:
  /// @param name  of the node; empty: an observer
  Member(std::shared_ptr<RingHandle> ring, broker::Node node, std::string name)
      : ring_{std::move(ring)}, node_{std::move(node)}, name_{std::move(name)} {}

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Values of signals [SI]; those of one tear group are from the same write.
  /// @throws Error for an unknown signal, or if a group's writer interferes with each read
  [[nodiscard]] std::vector<double> read(const std::vector<std::string>& signals);
  /// Checks all values, then writes them in this order; those of one tear group in one piece.
  /// @throws Error, and writes nothing, if a value does not fit or belongs to another node
  void write(const std::vector<std::pair<std::string, Value>>& values);
  /// The words of a partition in the ring's memory: to store through for a plain node's own
  /// partitions, otherwise `is_writable` is false.
  struct Words {
    std::span<const std::uint32_t> words;
    bool is_writable = false;
  };
  [[nodiscard]] Words words_of(const std::string& partition);
  void beat() { node().beat(); }
  [[nodiscard]] std::uint64_t beats_of(const std::string& node);
  /// "absent", "alive" or "vanished".
  [[nodiscard]] std::string presence_of(const std::string& node);
  [[nodiscard]] bool has_left() const { return !node_; }
  /// Leaves the ring. Views stay valid.
  void leave() { node_.reset(); }
  [[nodiscard]] const std::shared_ptr<RingHandle>& ring() const { return ring_; }

 private:
  /// @throws Error if it has left
  [[nodiscard]] broker::Node& node();
  /// @throws Error if memory of the ring was lost: then reads returned zeros
  void check_memory();
  void check_owner(const memmap::SignalEntry& entry);
  [[nodiscard]] std::vector<std::uint32_t> group_of(const memmap::Partition& partition);
  void write_word(const memmap::SignalEntry& entry, std::uint32_t word);

  std::shared_ptr<RingHandle> ring_;  // before the node, which leaves it
  std::optional<broker::Node> node_;  ///< empty: has left
  std::string name_;
};

}  // namespace rths::python
