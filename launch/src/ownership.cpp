// SPDX-License-Identifier: Apache-2.0
#include "ownership.hpp"

#include <algorithm>

#include <rths/broker/watch_text.hpp>

namespace rths::launch {
namespace {

constexpr Duration kOwnershipLook = std::chrono::milliseconds{2};
// Beyond the time after which a store is judged whose owner does not beat.
constexpr int kLastLooks = 75;

}  // namespace

OwnershipWatch::OwnershipWatch(broker::Ring& ring)
    : map_{ring.map()}, watch_{ring, broker::Journalling::None}, thread_{[this] { run(); }} {}

// A store at the very end is judged, too.
void OwnershipWatch::run() {
  WallClock clock;
  for (int looks_left = kLastLooks; looks_left > 0;) {
    for (auto& store : watch_.look()) {
      Found& found = found_[store.offset.value()];
      if (++found.count == 1) found.first = std::move(store);
    }
    if (ends_.load(std::memory_order_relaxed))
      looks_left -= watch_.has_suspicion() ? 1 : kLastLooks;
    clock.sleep_until(clock.now() + kOwnershipLook);
  }
}

void OwnershipWatch::end() {
  ends_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

std::vector<recording::ForeignStore> OwnershipWatch::finish(TimePoint epoch) {
  end();
  std::vector<recording::ForeignStore> stores;
  for (const auto& [offset, found] : found_)
    stores.push_back({broker::word_name(map_, found.first.offset), found.first.owner,
                      std::max(0.0, to_seconds(found.first.seen - epoch)),
                      broker::word_value(map_, found.first.offset, found.first.value), found.count,
                      broker::writers_of(found.first)});
  std::sort(stores.begin(), stores.end(),
            [](const auto& a, const auto& b) { return a.time < b.time; });
  return stores;
}

}  // namespace rths::launch
