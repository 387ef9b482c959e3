// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/ids.hpp>
#include <rths/core/realtime.hpp>
#include <rths/core/status.hpp>

namespace rths::broker {

class Drowsy;

/// One write of a node: of a word, or of a tear group.
struct Write {
  NodeId writer;
  LongwordOffset offset;                   ///< of the word, or of the group's first word
  std::uint32_t value = 0;                 ///< of the word
  std::span<const std::uint32_t> group{};  ///< its words, until the next call; empty for a word
};

/// What a look into a journal came to.
enum class Followed {
  Write,    ///< the next write
  Nothing,  ///< nothing was written since
  Lost,     ///< the writer was more than a journal ahead: what was in between is gone, go on
};

/// Reads the writes of one node, each once and in the order in which they were made, beginning now.
///
/// Neither disturbs the writer nor is known to it. A journal holds the last 2^bits entries of its
/// writer; who falls further behind is told so and goes on with the newest.   One thread.
class Follower {
 public:
  Follower(Follower&&) noexcept;
  Follower& operator=(Follower&&) noexcept;
  ~Follower();

  /// @realtime
  [[nodiscard]] Followed next(Write& write) RTHS_REALTIME;
  /// Entries that were gone before they could be read.
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

/// Waits for writes to some words without looking at the words: by following the journals of the
/// nodes that may write them, awake at first, then asleep.   One thread.
class Waiter {
 public:
  Waiter(Waiter&&) noexcept;
  Waiter& operator=(Waiter&&) noexcept;
  ~Waiter();

  /// The next write to any of the words, in each writer's own order.
  /// @returns Ok; Late if there was none until `deadline` (CLOCK_MONOTONIC); LimitExceeded if some
  ///          were lost, and `write` is not set   @realtime, but for the sleep
  [[nodiscard]] Status wait(TimePoint deadline, Write& write) RTHS_REALTIME;

 private:
  friend class Ring;
  struct State;
  explicit Waiter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// Who wrote a word last, and when, as far as the journals still tell.
struct LastWrite {
  std::string node;                    ///< the word's owner in the map; empty if it has none
  std::optional<std::uint32_t> value;  ///< empty if the journal no longer, or not yet, has a write
  TimePoint not_before{0};             ///< of the write [CLOCK_MONOTONIC]; 0 if that is unknown.
  TimePoint not_after{0};              ///< Without a value: the word is older than this
};

}  // namespace rths::broker
