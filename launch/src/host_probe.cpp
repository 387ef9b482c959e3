// SPDX-License-Identifier: Apache-2.0
#include "host_probe.hpp"

#include <algorithm>

#include "realtime_thread.hpp"

namespace rths::launch {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{1};
constexpr int kPeriodsPerInterval = 10;

}  // namespace

HostProbe::HostProbe(TimePoint epoch, double longest_run) {
  lateness_.interval = to_seconds(kPeriod * kPeriodsPerInterval);
  lateness_.largest.assign(static_cast<std::size_t>(longest_run / lateness_.interval) + 1, 0.0);
  thread_ = std::thread{[this, epoch] { run(epoch); }};
}

HostProbe::~HostProbe() { static_cast<void>(finish()); }

void HostProbe::run(TimePoint epoch) {
  static_cast<void>(make_realtime(kProbePriority));
  WallClock clock;
  for (std::size_t tick = 0; !finish_.load(std::memory_order_relaxed); ++tick) {
    const TimePoint due = epoch + kPeriod * tick;
    clock.sleep_until(due);
    const double late = to_seconds(clock.now() - due);
    const std::size_t interval = tick / kPeriodsPerInterval;
    if (interval >= lateness_.largest.size()) return;
    lateness_.largest[interval] = std::max(lateness_.largest[interval], late);
    used_ = interval + 1;
  }
}

HostLateness HostProbe::finish() {
  finish_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
  lateness_.largest.resize(std::min(used_, lateness_.largest.size()));
  return lateness_;
}

}  // namespace rths::launch
