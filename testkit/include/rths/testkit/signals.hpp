// SPDX-License-Identifier: Apache-2.0
//
// A ring by the names of its signals, in SI.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/memmap/map.hpp>

namespace rths::testkit {

class SignalFollower;
class SignalNode;

/// A value to write: a number [SI], or the name of one of the signal's values.
using Value = std::variant<double, std::string>;

/// A ring, and the codecs of its signals. Its nodes and followers share it, so the ring's memory
/// stays mapped until the last of them is destroyed. All functions @setup.
class SignalRing : public std::enable_shared_from_this<SignalRing> {
 public:
  explicit SignalRing(broker::Ring ring);

  /// @param map_file  a map file   @throws Error as broker::Ring::create
  [[nodiscard]] static std::shared_ptr<SignalRing> create(const std::string& name,
                                                          const std::string& map_file);
  [[nodiscard]] static std::shared_ptr<SignalRing> attach(const std::string& name);
  [[nodiscard]] static std::shared_ptr<SignalRing> in_process(const std::string& map_file);

  /// @throws Error as broker::Ring::join and broker::Ring::join_plain
  [[nodiscard]] std::unique_ptr<SignalNode> join(const std::string& node, bool plain = false);
  [[nodiscard]] std::unique_ptr<SignalNode> observe();
  /// Follows the writes to signals from now on. @throws Error for an unknown one, or if none
  [[nodiscard]] std::unique_ptr<SignalFollower> follow(const std::vector<std::string>& signals);

  [[nodiscard]] broker::Ring& ring() { return ring_; }
  [[nodiscard]] const memmap::Map& map() const { return ring_.map(); }
  /// @throws Error with the most similar known name
  [[nodiscard]] const memmap::SignalEntry& entry(const std::string& signal) const;
  [[nodiscard]] const memmap::Partition& partition(const std::string& name) const;
  /// The codec of a signal, made once: reading a unit takes longer than a word.
  [[nodiscard]] const memmap::Codec& codec(const memmap::SignalEntry& entry);
  /// Value of a signal [SI]. @throws Error with the names of its values for an unknown one
  [[nodiscard]] double number(const memmap::SignalEntry& entry, const Value& value);

 private:
  broker::Ring ring_;
  std::vector<std::optional<memmap::Codec>> codecs_;  ///< in the order of the map's signals
};

/// Membership of this program on a ring, as a node of the map or as an observer. None of its
/// functions waits.   One thread.
class SignalNode {
 public:
  /// @param name  of the node; empty: an observer
  SignalNode(std::shared_ptr<SignalRing> ring, broker::Node node, std::string name)
      : ring_{std::move(ring)}, node_{std::move(node)}, name_{std::move(name)} {}

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Value of a signal [SI]. @throws Error as for many
  [[nodiscard]] double read(const std::string& signal) { return read(std::vector{signal})[0]; }
  /// Values of signals [SI]; those of one tear group are from the same write.
  /// @throws Error for an unknown signal, or if a group's writer interferes with each read
  [[nodiscard]] std::vector<double> read(const std::vector<std::string>& signals);
  void write(const std::string& signal, Value value) { write({{signal, std::move(value)}}); }
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
  /// Leaves the ring. `Words` stay valid.
  void leave() { node_.reset(); }
  [[nodiscard]] const std::shared_ptr<SignalRing>& ring() const { return ring_; }

 private:
  /// @throws Error if it has left
  [[nodiscard]] broker::Node& node();
  /// @throws Error if memory of the ring was lost: then reads returned zeros
  void check_memory();
  void check_owner(const memmap::SignalEntry& entry);
  [[nodiscard]] std::vector<std::uint32_t> group_of(const memmap::Partition& partition);
  void write_word(const memmap::SignalEntry& entry, std::uint32_t word);

  std::shared_ptr<SignalRing> ring_;  // before the node, which leaves it
  std::optional<broker::Node> node_;  ///< empty: has left
  std::string name_;
};

/// One write to followed signals: a word, or all followed words of a tear group.
struct Change {
  std::string node;                                    ///< the writer
  std::vector<std::pair<std::string, double>> values;  ///< by signal [SI]
};

/// Waits for the writes to given signals, each once and in its writer's order, beginning now.
/// One thread.
class SignalFollower {
 public:
  SignalFollower(std::shared_ptr<SignalRing> ring, const std::vector<std::string>& signals);

  /// Waits for the next write, at most until the deadline.
  /// @returns Ok; Late if there was none; LimitExceeded if it was more than a journal behind: it
  ///          continues at the newest write
  [[nodiscard]] Status wait(TimePoint deadline, broker::Write& write) {
    return waiter_->wait(deadline, write);
  }
  /// The followed signals of a write.   @setup
  [[nodiscard]] Change change_of(const broker::Write& write);

 private:
  std::shared_ptr<SignalRing> ring_;  // before the waiter, which is on the ring
  std::vector<const memmap::SignalEntry*> entries_;
  std::optional<broker::Waiter> waiter_;
};

}  // namespace rths::testkit
