// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unistd.h>

#include <cstdint>
#include <string>
#include <vector>

#include <rths/bench/round_trip.hpp>
#include <rths/broker/ring.hpp>

namespace rths::bench {

/// A ring in shared memory for one measurement: a node and a partition for each side.
class BenchRing {
 public:
  /// @param longwords   of each partition
  /// @param tear_group  whether partitions are written and read whole
  BenchRing(std::uint32_t longwords, bool tear_group);
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

/// A record that is read whole: `Node::write_group` and `Node::read_group`.
class GroupEnd {
 public:
  GroupEnd(const BenchRing& ring, Side side);
  void send(std::uint32_t number);
  /// Reads the record whole, as often as it is asked. @throws Error if it is torn
  [[nodiscard]] bool arrived(std::uint32_t number);

  /// For the cost of writing under a reader who reads all the time.
  void write(std::uint32_t number) { send(number); }
  void read();

 private:
  RingPlace place_;
  TearGroupId out_group_, in_group_;
  std::vector<std::uint32_t> out_, in_;
};

}  // namespace rths::bench
