// SPDX-License-Identifier: Apache-2.0
//
// How fast journals are followed.
#include <algorithm>
#include <atomic>

#include <rths/bench/stream.hpp>

#include "ring_end.hpp"
#include "ring_rows.hpp"

namespace rths::bench {
namespace {

constexpr std::uint32_t kLongJournalBits = 20;        // 16 MiB: 20 ms at the fastest of these rates
constexpr double kWriteTimes[] = {10, 20, 50, 1000};  // [ns]
constexpr std::uint32_t kBurst = 16;
constexpr std::uint32_t kWritesPerTrip = 80;  // so that a journal is written several times over

/// Writes at a steady rate, in short bursts, while the other side follows.
/// @returns true if it got them all
bool all_followed(const Workbench& bench, const BenchRing& ring, double write_time) {
  const std::uint32_t writes = std::max(kWritesPerTrip * bench.setup.round_trips, kBurst);
  const Shared<std::atomic<std::uint32_t>> ready;
  const Shared<std::atomic<std::uint32_t>> got_all;
  Partner reader{bench.setup.cpus.far, [&] {
                   RingPlace place{ring, Side::Far};
                   auto journal = place.ring.follow(place.in_partition);
                   broker::Write write;
                   ready->store(1, std::memory_order_release);
                   Patience patience;
                   while (journal.lost() == 0 && write.value != writes)
                     if (journal.next(write) == broker::Followed::Nothing) patience.spend();
                   got_all->store(journal.lost() == 0 ? 1 : 0);
                 }};
  const Pinned pinned{bench.setup.cpus.near};
  RingPlace place{ring, Side::Near};
  await_ready(*ready, reader);
  const std::uint64_t begun = stamp();
  for (std::uint32_t n = 1; n <= writes; ++n) {
    static_cast<void>(place.node.write(advance(place.out, n % ring.longwords()), n));
    if (n % kBurst != 0) continue;
    while (static_cast<double>(stamp() - begun) * bench.setup.tick < n * write_time) {
    }
  }
  reader.join();
  return got_all->load() == 1;
}

}  // namespace

Pairing measure_journal_follow(const Row&, const Workbench& bench) {
  const BenchRing ring{kManyWords, false, kLongJournalBits};
  for (const double write_time : kWriteTimes)
    if (all_followed(bench, ring, write_time))
      return {{write_time, write_time}, {write_time, write_time}};
  throw Error{"a follower lost writes at every rate"};
}

Times stream_of_words(const Workbench& bench) {
  const BenchRing ring{kManyWords, false};
  return stream_times(bench.setup, [&](Side side) { return StreamEnd{ring, side}; });
}

}  // namespace rths::bench
