// SPDX-License-Identifier: Apache-2.0
#include "host_probe.hpp"

#include <sched.h>

#include <algorithm>

#include "realtime_thread.hpp"

namespace rths::launch {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{1};
constexpr int kPeriodsPerInterval = 10;

// Those that this run may use: its nodes run on any of them.
std::vector<int> processors() {
  std::vector<int> found;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return {0};
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<unsigned>(cpu), &allowed)) found.push_back(cpu);
  return found;
}

void keep_to(int cpu) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<unsigned>(cpu), &only);
  static_cast<void>(sched_setaffinity(0, sizeof only, &only));
}

}  // namespace

HostProbe::HostProbe(TimePoint epoch, double longest_run) {
  const auto intervals =
      static_cast<std::size_t>(longest_run / to_seconds(kPeriod * kPeriodsPerInterval)) + 1;
  for (const int cpu : processors()) {
    Watch& watch = watches_.emplace_back();
    watch.cpu = cpu;
    watch.largest.assign(intervals, 0.0);
    watch.thread = std::thread{[this, &watch, epoch] { run(watch, epoch); }};
  }
}

HostProbe::~HostProbe() { static_cast<void>(finish()); }

void HostProbe::run(Watch& watch, TimePoint epoch) const {
  keep_to(watch.cpu);
  static_cast<void>(make_realtime(kProbePriority));
  WallClock clock;
  for (std::size_t tick = 0; !finish_.load(std::memory_order_relaxed); ++tick) {
    const TimePoint due = epoch + kPeriod * tick;
    clock.sleep_until(due);
    const double late = to_seconds(clock.now() - due);
    const std::size_t interval = tick / kPeriodsPerInterval;
    if (interval >= watch.largest.size()) return;
    watch.largest[interval] = std::max(watch.largest[interval], late);
    watch.used = interval + 1;
  }
}

HostLateness HostProbe::finish() {
  finish_.store(true, std::memory_order_relaxed);
  HostLateness lateness;
  lateness.interval = to_seconds(kPeriod * kPeriodsPerInterval);
  for (auto& watch : watches_) {
    if (watch.thread.joinable()) watch.thread.join();
    lateness.largest.resize(std::max(lateness.largest.size(), watch.used));
    for (std::size_t i = 0; i < watch.used; ++i)
      lateness.largest[i] = std::max(lateness.largest[i], watch.largest[i]);
  }
  return lateness;
}

}  // namespace rths::launch
