// SPDX-License-Identifier: Apache-2.0
#include "clock_offset.hpp"

#include <algorithm>
#include <ctime>

namespace rths::dds {
namespace {

constexpr TimePoint kLatest{std::int64_t{1} << 60};  // 36 years; sums of two stay in range
constexpr Duration kLongestTrip = std::chrono::seconds{1};
constexpr double kDrift = 100e-6;  // between two clocks of 50 ppm each

bool is_possible(TimePoint time) { return time >= TimePoint{0} && time < kLatest; }

}  // namespace

Duration real_time_offset() {
  timespec real{}, monotonic{};
  clock_gettime(CLOCK_REALTIME, &real);
  clock_gettime(CLOCK_MONOTONIC, &monotonic);
  return std::chrono::seconds{real.tv_sec - monotonic.tv_sec} +
         Duration{real.tv_nsec - monotonic.tv_nsec};
}

void ClockOffset::add(TimePoint sent, TimePoint received, TimePoint answered, TimePoint now) {
  if (!is_possible(sent) || !is_possible(received) || !is_possible(answered)) return;
  const Duration round_trip = (now - sent) - (answered - received);
  if (sent > now || received > answered || round_trip < Duration{0} || round_trip > kLongestTrip)
    return;
  const Duration offset = ((received - sent) + (answered - now)) / 2;
  exchanges_[count_++ % exchanges_.size()] = {offset, round_trip, now};
}

std::optional<ClockOffset::Estimate> ClockOffset::at(TimePoint now) const {
  std::optional<Estimate> best;
  for (std::size_t i = 0; i < std::min(count_, exchanges_.size()); ++i) {
    const Exchange& exchange = exchanges_[i];
    const double drift = kDrift * to_seconds(now - exchange.time);
    const Duration error = exchange.round_trip / 2 + from_seconds(drift);
    if (!best || error < best->error) best = Estimate{exchange.offset, error};
  }
  return best;
}

}  // namespace rths::dds
