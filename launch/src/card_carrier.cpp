// SPDX-License-Identifier: Apache-2.0
#include "card_carrier.hpp"

#include <limits>

#include "realtime_thread.hpp"

namespace rths::launch {
namespace {

constexpr Duration kScanPeriod = std::chrono::microseconds{50};
constexpr int kPriority = 65;  // between the host probe and the adapters
// No fault is due before the run begins.
constexpr replicated::Time kNever{std::numeric_limits<replicated::Time::rep>::max() / 2};

}  // namespace

CardCarrier::CardCarrier(replicated::Images& images)
    : images_{images}, thread_{[this] { run(); }} {}

CardCarrier::~CardCarrier() {
  ends_.store(true);
  thread_.join();
}

void CardCarrier::run() {
  static_cast<void>(make_realtime(kPriority));
  WallClock clock;
  const TimePoint start = clock.now();
  images_.begin(kNever);
  bool has_begun = false;
  while (!ends_.load(std::memory_order_relaxed)) {
    if (const auto epoch = epoch_.load(std::memory_order_relaxed); epoch != 0 && !has_begun) {
      has_begun = true;
      images_.begin(replicated::Time{TimePoint{epoch} - start});
    }
    images_.advance(replicated::Time{clock.now() - start});
    clock.sleep_until(clock.now() + kScanPeriod);
  }
}

}  // namespace rths::launch
