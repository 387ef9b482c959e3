// SPDX-License-Identifier: Apache-2.0
//
// The rate at which a journal can be followed.
#include <algorithm>
#include <atomic>
#include <optional>

#include <rths/bench/stream.hpp>

#include "ring_end.hpp"
#include "ring_rows.hpp"

namespace rths::bench {
namespace {

constexpr std::uint32_t kLongJournalBits = 20;  // 16 MiB: 10 ms at the fastest of these rates
constexpr std::uint32_t kWrites = 8U << kLongJournalBits;  // a slow follower loses some of these
constexpr double kWriteTimes[] = {10, 20, 50, 1000};       // [ns]
constexpr std::uint32_t kBurst = 16;

/// Follows the other side's writes to the last one, or until some are lost.
void follow_writes(const BenchRing& ring, std::atomic<std::uint32_t>& ready,
                   std::atomic<std::uint32_t>& lost) {
  RingSide side{ring, Side::Far};
  auto journal = side.ring.follow(side.in_partition);
  broker::Write write;
  SpinLimit limit;
  ready.store(1, std::memory_order_release);
  for (std::uint32_t n = 1; n <= kWrites && journal.lost() == 0;) {
    if (journal.next(write) != broker::Followed::Write) {
      limit.count();
      continue;
    }
    limit.reset();
    if (write.value != n++) throw Error{"a write was followed out of order"};
  }
  lost.store(journal.lost() == 0 ? 0 : 1);
}

/// Writes at a constant rate, in short bursts, while the other side follows.
/// @returns time per write until the last one was read [ns]; nothing if writes were lost
std::optional<double> time_of_followed_write(const Workbench& bench, const BenchRing& ring,
                                             double write_time) {
  const Shared<std::atomic<std::uint32_t>> ready;
  const Shared<std::atomic<std::uint32_t>> lost;
  Partner reader{bench.setup.cpus.far, [&] { follow_writes(ring, *ready, *lost); }};
  const Pinned pinned{bench.setup.cpus.near};
  RingSide side{ring, Side::Near};
  await_ready(*ready, reader);
  const std::uint64_t begun = stamp();
  const auto since = [&] { return static_cast<double>(stamp() - begun) * bench.setup.tick; };
  for (std::uint32_t n = 1; n <= kWrites; ++n) {
    static_cast<void>(side.node.write(advance(side.out, n % ring.longwords()), n));
    while (n % kBurst == 0 && since() < n * write_time) {
    }
  }
  reader.join();
  return lost->load() == 0 ? std::optional{since() / kWrites} : std::nullopt;
}

}  // namespace

Pairing measure_journal_follow(const Row&, const Workbench& bench) {
  const BenchRing ring{kManyWords, false, kLongJournalBits};
  for (const double write_time : kWriteTimes)
    if (const auto time = time_of_followed_write(bench, ring, write_time))
      return {{*time, *time}, {write_time, write_time}};
  throw Error{"a follower lost writes at every rate"};
}

Times stream_of_words(const Workbench& bench) {
  const BenchRing ring{kManyWords, false};
  return stream_times(bench.setup, [&](Side side) { return StreamEnd{ring, side}; });
}

}  // namespace rths::bench
