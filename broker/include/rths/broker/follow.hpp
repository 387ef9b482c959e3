// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/ids.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::broker {

/// One write of a node: a word or a tear group.
struct Write {
  NodeId writer;
  LongwordOffset offset;                 ///< of the word, or of the group's first word
  std::uint32_t value = 0;               ///< of the word
  std::span<const std::uint32_t> group;  ///< words of the group, valid until the next call
};

/// Result of reading a journal.
enum class Followed {
  Write,    ///< the next write
  Nothing,  ///< no new write
  Lost,     ///< more than a journal behind: skipped to the newest entry
};

/// Reads the writes of one node, each once and in order, beginning now.
///
/// Does not affect the writer. A journal has the last 2^bits entries of its writer; a follower that
/// is further behind gets `Lost` and continues at the newest entry.   One thread.
class Follower {
 public:
  Follower(Follower&&) noexcept;
  Follower& operator=(Follower&&) noexcept;
  ~Follower();

  /// Reads the next write.   @realtime
  [[nodiscard]] Followed next(Write& write) RTHS_REALTIME;
  /// Reads the next write if it was made before this time. The writer's next heartbeat dates its
  /// writes; without one, they have no time yet.   @realtime
  [[nodiscard]] Followed next_until(TimePoint time, Write& write) RTHS_REALTIME;
  /// Skips the writes until now.   @realtime
  void skip_to_end() RTHS_REALTIME;
  /// Number of entries that were overwritten before they were read.
  [[nodiscard]] std::uint64_t lost() const;

 private:
  friend class Ring;
  friend class Waiter;
  struct State;
  explicit Follower(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Consecutive words.
struct LongwordRange {
  LongwordOffset begin;
  std::uint32_t longwords = 1;
};

/// Waits for writes to given words. Follows the journals of the nodes that may write them, first
/// spinning, then sleeping; does not poll the words.   One thread.
class Waiter {
 public:
  Waiter(Waiter&&) noexcept;
  Waiter& operator=(Waiter&&) noexcept;
  ~Waiter();

  /// Waits for the next write to any of the words, in each writer's own order.
  /// @param deadline  on CLOCK_MONOTONIC; 0: does not wait
  /// @returns Ok; Late if there was none until the deadline; LimitExceeded, with
  ///          `write` not set, if writes were lost   @realtime, except for the sleep
  [[nodiscard]] Status wait(TimePoint deadline, Write& write) RTHS_REALTIME;
  /// Ignores the writes of a node, or follows them again from now on.   @realtime
  void ignore(NodeId writer, bool ignored) RTHS_REALTIME;

 private:
  friend class Node;
  friend class Ring;
  struct State;
  explicit Waiter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Writer and time of the last write to a word, as far as the journals still have it.
struct LastWrite {
  std::string node;                    ///< owner of the word in the map; empty if it has none
  std::optional<std::uint32_t> value;  ///< empty if the journal has no write to the word
  TimePoint not_before{0};             ///< earliest time of the write [CLOCK_MONOTONIC]; 0: unknown
  TimePoint not_after{0};              ///< latest time of the write; known also without a value
};

}  // namespace rths::broker
