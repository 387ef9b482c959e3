// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/stamp.hpp>

#include <chrono>

namespace rths::bench {

double measure_tick() {
  using std::chrono::steady_clock;
  constexpr auto kSpan = std::chrono::milliseconds{20};  // reading the clocks adds an error of 1e-6
  const auto begun = steady_clock::now();
  const std::uint64_t first = stamp();
  auto now = begun;
  while (now - begun < kSpan) now = steady_clock::now();
  const std::uint64_t last = stamp();
  return std::chrono::duration<double, std::nano>(now - begun).count() /
         static_cast<double>(last - first);
}

}  // namespace rths::bench
