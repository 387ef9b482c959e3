// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

#include <rths/bench/round_trip.hpp>
#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>

namespace rths::bench {

/// Number of words that fit the first-level cache.
inline constexpr std::uint32_t kManyWords = 256;

/// A ring in shared memory for one measurement: a node and a partition for each side.
class BenchRing {
 public:
  /// @param longwords   of each partition
  /// @param tear_group  whether partitions are written and read whole
  BenchRing(std::uint32_t longwords, bool tear_group,
            std::uint32_t journal_bits = broker::kJournalBits);
  ~BenchRing();
  BenchRing(const BenchRing&) = delete;
  BenchRing& operator=(const BenchRing&) = delete;

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::uint32_t longwords() const { return longwords_; }

 private:
  std::string name_;
  std::uint32_t longwords_;
  broker::Ring ring_;
};

/// The ring as one side uses it; each process attaches to it by name, as any program would.
struct RingSide {
  RingSide(const BenchRing& bench_ring, Side side);

  broker::Ring ring;
  broker::Node node;
  LongwordOffset out, in;  ///< first longwords of the own partition and of the other side's
  std::string out_partition, in_partition;
};

/// Loose words: `Node::write` and `Node::read`.
class WordEnd {
 public:
  WordEnd(const BenchRing& ring, Side side) : side_{ring, side} {}
  void send(std::uint32_t number) { static_cast<void>(side_.node.write(side_.out, number)); }
  [[nodiscard]] bool arrived(std::uint32_t number) const {
    return side_.node.read(side_.in) == number;
  }

 private:
  RingSide side_;
};

/// One of many words, detected by following the other side's journal.
class AnyWordEnd {
 public:
  AnyWordEnd(const BenchRing& ring, Side side)
      : side_{ring, side},
        longwords_{ring.longwords()},
        follower_{side_.ring.follow(side_.in_partition)} {}
  void send(std::uint32_t number) {
    static_cast<void>(side_.node.write(advance(side_.out, number % longwords_), number));
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    return follower_.next(write_) == broker::Followed::Write && write_.value == number;
  }

 private:
  RingSide side_;
  std::uint32_t longwords_;
  broker::Follower follower_;
  broker::Write write_{};
};

/// A stream of words, detected in the same way. The receiver writes its progress into a word, so
/// that the sender stays within the journal's length.
class StreamEnd {
 public:
  StreamEnd(const BenchRing& ring, Side side);
  [[nodiscard]] bool offer(std::uint32_t number);
  [[nodiscard]] bool take(std::uint32_t& number);

 private:
  RingSide side_;
  std::uint32_t longwords_;
  std::uint32_t taken_ = 0;  ///< by the receiver, as last read by the sender
  broker::Follower follower_;
  broker::Write write_{};
};

/// A word that the side waits for: `Ring::wait_for`.
class WaitEnd {
 public:
  WaitEnd(const BenchRing& ring, Side side)
      : side_{ring, side}, waiter_{side_.ring.wait_for({{side_.in}})} {}
  void send(std::uint32_t number) { static_cast<void>(side_.node.write(side_.out, number)); }
  /// @throws Error if no word arrives for a second
  [[nodiscard]] bool arrived(std::uint32_t number);

 private:
  RingSide side_;
  broker::Waiter waiter_;
  broker::Write write_{};
};

/// A record that is read whole: `Node::write_group` and `Node::read_group`.
class GroupEnd {
 public:
  GroupEnd(const BenchRing& ring, Side side);
  void send(std::uint32_t number) {
    fill(number);
    write();
  }
  /// Reads the whole record once. @throws Error if it is torn
  [[nodiscard]] bool arrived(std::uint32_t number);

  void fill(std::uint32_t number) { out_.front() = out_.back() = number; }
  void write() { static_cast<void>(side_.node.write_group(out_group_, out_)); }
  void read();

 private:
  RingSide side_;
  TearGroupId out_group_, in_group_;
  std::vector<std::uint32_t> out_, in_;
};

}  // namespace rths::bench
