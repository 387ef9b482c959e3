// SPDX-License-Identifier: Apache-2.0
#include "ring_end.hpp"

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

constexpr std::uint32_t kLongwordsPerPair = 32;  // two cache lines, which processors fetch together
constexpr std::uint32_t kMostAhead = 4096;  // of the receiver; as in the queue it is compared with
constexpr std::uint32_t kConfirmEvery = 1024;
constexpr auto kLongestWait = std::chrono::seconds{1};
constexpr const char* kNear = "near";
constexpr const char* kFar = "far";

// The far partition begins on lines of its own, one pair of lines behind the near one.
LongwordOffset far_base(std::uint32_t longwords) {
  const std::uint32_t pairs = (longwords + kLongwordsPerPair - 1) / kLongwordsPerPair;
  return LongwordOffset{(pairs + 1) * kLongwordsPerPair};
}

memmap::Map map_of(std::uint32_t longwords, bool tear_group) {
  memmap::MapDescription description;
  description.name = "bench";
  description.nodes = {{kNear, NodeId{1}, ""}, {kFar, NodeId{2}, ""}};
  const LongwordOffset far = far_base(longwords);
  for (const auto& [node, base] : {std::pair{kNear, LongwordOffset{0}}, std::pair{kFar, far}}) {
    memmap::Partition partition;
    partition.name = node;
    partition.node = node;
    partition.base = base;
    partition.longwords = longwords;
    partition.tear_group = tear_group;
    description.partitions.push_back(partition);
  }
  constexpr std::uint32_t kSmallestCard = 1024;  // [longwords]
  description.size_longwords = kSmallestCard;
  while (description.size_longwords < far.value() + longwords) description.size_longwords *= 2;
  return memmap::Map{description};
}

}  // namespace

BenchRing::BenchRing(std::uint32_t longwords, bool tear_group, std::uint32_t journal_bits)
    : name_{fmt::format("bench_{}", getpid())},
      longwords_{longwords},
      ring_{broker::Ring::create(name_, map_of(longwords, tear_group), journal_bits)} {}

BenchRing::~BenchRing() { broker::remove_ring(name_); }

RingSide::RingSide(const BenchRing& bench_ring, Side side)
    : ring{broker::Ring::attach(bench_ring.name())},
      node{ring.join(side == Side::Near ? kNear : kFar, 0)},
      out{side == Side::Near ? LongwordOffset{0} : far_base(bench_ring.longwords())},
      in{side == Side::Near ? far_base(bench_ring.longwords()) : LongwordOffset{0}},
      out_partition{side == Side::Near ? kNear : kFar},
      in_partition{side == Side::Near ? kFar : kNear} {}

StreamEnd::StreamEnd(const BenchRing& ring, Side side)
    : side_{ring, side},
      longwords_{ring.longwords()},
      follower_{side_.ring.follow(side_.in_partition)} {}

bool StreamEnd::offer(std::uint32_t number) {
  if (number - taken_ >= kMostAhead) {
    taken_ = side_.node.read(side_.in);
    if (number - taken_ >= kMostAhead) return false;
  }
  return side_.node.write(advance(side_.out, number % longwords_), number) == Status::Ok;
}

bool StreamEnd::take(std::uint32_t& number) {
  if (follower_.next(write_) != broker::Followed::Write) return false;
  number = write_.value;
  if (++taken_ % kConfirmEvery == 0) static_cast<void>(side_.node.write(side_.out, taken_));
  return true;
}

bool WaitEnd::arrived(std::uint32_t number) {
  if (waiter_.wait(WallClock{}.now() + kLongestWait, write_) != Status::Ok)
    throw Error{"an awaited word did not arrive"};
  return write_.value == number;
}

GroupEnd::GroupEnd(const BenchRing& ring, Side side)
    : side_{ring, side},
      out_group_{side_.ring.tear_group(side_.out_partition)},
      in_group_{side_.ring.tear_group(side_.in_partition)},
      out_(ring.longwords(), 0),
      in_(ring.longwords(), 0) {}

bool GroupEnd::arrived(std::uint32_t number) {
  if (side_.node.read_group(in_group_, in_) != Status::Ok) return false;
  if (in_.front() != in_.back()) throw Error{"a record was read torn"};
  return in_.back() == number;
}

void GroupEnd::read() {
  if (side_.node.read_group(in_group_, in_) == Status::Ok && in_.front() != in_.back())
    throw Error{"a record was read torn"};
}

}  // namespace rths::bench
