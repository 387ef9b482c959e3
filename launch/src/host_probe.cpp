// SPDX-License-Identifier: Apache-2.0
#include "host_probe.hpp"

#include <sched.h>

namespace rths::launch {
namespace {

constexpr Duration kPeriod = std::chrono::milliseconds{1};
constexpr int kPeriodsPerInterval = 10;

// Processors that the nodes of this run may use.
std::vector<int> processors() {
  std::vector<int> found;
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return {0};
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(static_cast<unsigned>(cpu), &allowed)) found.push_back(cpu);
  return found;
}

void pin_to(int cpu) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<unsigned>(cpu), &only);
  static_cast<void>(sched_setaffinity(0, sizeof only, &only));
}

template <class T>
void raise_to(std::atomic<T>& largest, T value) {
  T before = largest.load(std::memory_order_relaxed);
  while (before < value &&
         !largest.compare_exchange_weak(before, value, std::memory_order_relaxed)) {
  }
}

std::size_t intervals_of(double longest_run) {
  return static_cast<std::size_t>(longest_run / to_seconds(kPeriod * kPeriodsPerInterval)) + 1;
}

}  // namespace

HostProbe::HostProbe(TimePoint epoch, double longest_run) : largest_(intervals_of(longest_run)) {
  for (const int cpu : processors()) threads_.emplace_back([this, cpu, epoch] { run(cpu, epoch); });
}

HostProbe::~HostProbe() { static_cast<void>(finish()); }

void HostProbe::run(int cpu, TimePoint epoch) {
  pin_to(cpu);
  static_cast<void>(make_realtime(kProbePriority));
  WallClock clock;
  for (std::size_t tick = 0; !finish_.load(std::memory_order_relaxed); ++tick) {
    const TimePoint due = epoch + kPeriod * tick;
    clock.sleep_until(due);
    const std::size_t interval = tick / kPeriodsPerInterval;
    if (interval >= largest_.size()) return;
    raise_to(largest_[interval], static_cast<float>(to_seconds(clock.now() - due)));
    raise_to(used_, interval + 1);
  }
}

HostLateness HostProbe::finish() {
  finish_.store(true, std::memory_order_relaxed);
  for (auto& thread : threads_)
    if (thread.joinable()) thread.join();
  HostLateness lateness;
  lateness.interval = to_seconds(kPeriod * kPeriodsPerInterval);
  for (std::size_t i = 0; i < used_; ++i)
    lateness.largest.push_back(static_cast<double>(largest_[i].load()));
  return lateness;
}

}  // namespace rths::launch
