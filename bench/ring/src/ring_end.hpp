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

/// So that writes to any of them are told apart, and stay in the first cache.
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

/// A side's place on that ring; each process attaches to it by name, as any program would.
struct RingPlace {
  RingPlace(const BenchRing& bench_ring, Side side);

  broker::Ring ring;
  broker::Node node;
  LongwordOffset out, in;  ///< first longword of the own partition, and of the other's
  std::string out_partition, in_partition;
};

/// Loose words: `Node::write` and `Node::read`.
class WordEnd {
 public:
  WordEnd(const BenchRing& ring, Side side) : place_{ring, side} {}
  void send(std::uint32_t number) { static_cast<void>(place_.node.write(place_.out, number)); }
  [[nodiscard]] bool arrived(std::uint32_t number) const {
    return place_.node.read(place_.in) == number;
  }

 private:
  RingPlace place_;
};

/// One of many words, noticed by following the other side's journal.
class AnyWordEnd {
 public:
  AnyWordEnd(const BenchRing& ring, Side side)
      : place_{ring, side},
        longwords_{ring.longwords()},
        follower_{place_.ring.follow(place_.in_partition)} {}
  void send(std::uint32_t number) {
    static_cast<void>(place_.node.write(advance(place_.out, number % longwords_), number));
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    return follower_.next(write_) == broker::Followed::Write && write_.value == number;
  }

 private:
  RingPlace place_;
  std::uint32_t longwords_;
  broker::Follower follower_;
  broker::Write write_{};
};

/// A stream of words, noticed like that. The receiver says in a word how far it has come, so that
/// the sender does not outrun it.
class StreamEnd {
 public:
  StreamEnd(const BenchRing& ring, Side side);
  [[nodiscard]] bool offer(std::uint32_t number);
  [[nodiscard]] bool take(std::uint32_t& number);

 private:
  RingPlace place_;
  std::uint32_t longwords_;
  std::uint32_t taken_ = 0;  ///< by the receiver, as far as the sender knows
  broker::Follower follower_;
  broker::Write write_{};
};

/// A word that is waited for: `Ring::wait_for`.
class WaitEnd {
 public:
  WaitEnd(const BenchRing& ring, Side side)
      : place_{ring, side}, waiter_{place_.ring.wait_for({{place_.in}})} {}
  void send(std::uint32_t number) { static_cast<void>(place_.node.write(place_.out, number)); }
  /// @throws Error if there is nothing for a second
  [[nodiscard]] bool arrived(std::uint32_t number);

 private:
  RingPlace place_;
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
  /// Reads the record whole, as often as it is asked. @throws Error if it is torn
  [[nodiscard]] bool arrived(std::uint32_t number);

  void fill(std::uint32_t number) { out_.front() = out_.back() = number; }
  void write() { static_cast<void>(place_.node.write_group(out_group_, out_)); }
  void read();

 private:
  RingPlace place_;
  TearGroupId out_group_, in_group_;
  std::vector<std::uint32_t> out_, in_;
};

}  // namespace rths::bench
