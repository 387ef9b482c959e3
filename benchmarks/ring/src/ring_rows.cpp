// SPDX-License-Identifier: Apache-2.0
//
// Our rows, one small function each. A row that is timed by round trips measures raw first.
#include "ring_rows.hpp"

#include <array>
#include <atomic>

#include <rths/bench/write_cost.hpp>
#include <rths/broker/ring.hpp>

#include "ring_end.hpp"

namespace rths::bench {
namespace {

// Words of one page: sequential writes stay in the first-level cache, so memory does not limit
// them.
constexpr std::uint32_t kPageLongwords = 1024;

template <Poll poll, class End>
Pairing over_ring(const Workbench& bench, std::uint32_t longwords, bool tear_group = false) {
  const BenchRing ring{longwords, tear_group};
  const Times raw = raw_round_trips(bench.setup);
  return {round_trips<poll>(bench.setup, [&](Side side) { return End{ring, side}; }), raw};
}

}  // namespace

Pairing measure_raw(const Row&, const Workbench& bench) {
  const Times raw = raw_round_trips(bench.setup);
  return {raw_round_trips(bench.setup), raw};
}

Pairing measure_raw_paused(const Row&, const Workbench& bench) {
  const Times raw = raw_round_trips(bench.setup);
  return {raw_round_trips<Poll::Paused>(bench.setup), raw};
}

Pairing measure_word(const Row&, const Workbench& bench) {
  return over_ring<Poll::Tight, WordEnd>(bench, 1);
}

Pairing measure_word_paused(const Row&, const Workbench& bench) {
  return over_ring<Poll::Paused, WordEnd>(bench, 1);
}

Pairing measure_any_word(const Row&, const Workbench& bench) {
  return over_ring<Poll::Tight, AnyWordEnd>(bench, kManyWords);
}

Pairing measure_any_word_paused(const Row&, const Workbench& bench) {
  return over_ring<Poll::Paused, AnyWordEnd>(bench, kManyWords);
}

Pairing measure_group(const Row& row, const Workbench& bench) {
  return over_ring<Poll::Tight, GroupEnd>(bench, row.bytes / kBytesPerLongword, true);
}

Pairing measure_wait_spinning(const Row&, const Workbench& bench) {
  return over_ring<Poll::Tight, WaitEnd>(bench, 1);
}

Pairing measure_write_cost(const Row&, const Workbench& bench) {
  const Shared<std::array<std::uint32_t, kPageLongwords>> plain;
  const Times stores = write_times(bench.setup, [&](std::uint32_t i) {
    std::atomic_ref{(*plain)[i % kPageLongwords]}.store(i, std::memory_order_release);
  });
  const BenchRing ring{kPageLongwords, false};
  RingSide side{ring, Side::Near};
  const Times writes = write_times(bench.setup, [&](std::uint32_t i) {
    static_cast<void>(side.node.write(LongwordOffset{i % kPageLongwords}, i));
  });
  return {writes, stores};
}

Times write_group_under_reader(const Row& row, const Workbench& bench, std::uint32_t gap) {
  // The far side reads the group that the near side writes.
  const BenchRing ring{row.bytes / kBytesPerLongword, true};
  return write_times_under_reader(bench.setup, gap, [&](Side side) {
    return GroupEnd{ring, side};
  });
}

}  // namespace rths::bench
