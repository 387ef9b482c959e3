// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <future>
#include <thread>
#include <vector>

namespace rths {

/// Calls `run(i)` for each i below `count`, as many at a time as there are threads. The order is
/// not fixed: `run` may only write what belongs to i.
/// @throws what a call throws, when those that had begun have ended: no other one begins   @setup
template <class Run>
void side_by_side(std::size_t count, const Run& run,
                  std::size_t threads = std::thread::hardware_concurrency()) {
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    try {
      for (std::size_t i = next++; i < count; i = next++) run(i);
    } catch (...) {
      next = count;
      throw;
    }
  };
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < std::min(threads, count); ++i)
    others.push_back(std::async(std::launch::async, work));
  work();  // if it throws, the futures wait for the others
  for (auto& other : others) other.get();
}

}  // namespace rths
