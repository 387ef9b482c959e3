// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <vector>

namespace rths::budget {

/// Calls `run(i)` for each i below `count`, one on each processor at a time. The order is not
/// fixed: `run` may only write what belongs to i.
/// @throws what a call throws, when all have ended; the others may then be missing   @setup
template <class Run>
void side_by_side(std::size_t count, const Run& run) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) run(i);
  };
  const std::size_t threads = std::min<std::size_t>(std::thread::hardware_concurrency(), count);
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < threads; ++i) others.push_back(std::async(std::launch::async, work));
  work();  // if it throws, the futures wait for the others
  for (auto& other : others) other.get();
}

}  // namespace rths::budget
