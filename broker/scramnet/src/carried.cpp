// SPDX-License-Identifier: Apache-2.0
#include "carried.hpp"

#include <ctime>

#include <rths/card/monotonic_time.hpp>

namespace rths::scramnet {
namespace {

constexpr std::int64_t kLongestScanNs = 100'000'000;  // of a busy host
constexpr long kScanPollNs = 20'000;

template <class Condition>
void wait_while(Condition condition) {
  const std::int64_t deadline = now_ns() + kLongestScanNs;
  const timespec pause{0, kScanPollNs};
  while (condition() && now_ns() < deadline) clock_nanosleep(CLOCK_MONOTONIC, 0, &pause, nullptr);
}

}  // namespace

void wait_for_scan(const Carried& carried) {
  const std::uint32_t before = carried.scans.load();
  wait_while([&] { return carried.scans.load() - before < 2; });  // one may have begun before
}

void wait_for_own_stores(const Carried& carried) {
  const std::uint32_t last = carried.traps.reserved.load();
  wait_while([&] {
    return static_cast<std::int32_t>(carried.traps.taken.load() - last) < 0 ||
           carried.transmit_fifo.load() != 0;
  });
  wait_for_scan(carried);  // the last message may still be on the ring
}

}  // namespace rths::scramnet
