// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include <rths/core/clock.hpp>

#include "run_modes.hpp"

namespace rths::launch {

/// Measures the wake-up latency of the host: an idle thread on each processor wakes every
/// millisecond and records its lateness. Each processor needs its own thread, because the host can
/// stop one while others run.
class HostProbe {
 public:
  explicit HostProbe(TimePoint epoch, double longest_run);
  ~HostProbe();
  HostProbe(const HostProbe&) = delete;
  HostProbe& operator=(const HostProbe&) = delete;

  /// Ends the threads. @returns the largest lateness in each 10 ms, over all processors
  [[nodiscard]] HostLateness finish();

 private:
  void run(int cpu, TimePoint epoch);
  std::vector<std::atomic<float>> largest_;  ///< per interval, over all processors [s]
  std::atomic<std::size_t> used_{0};         ///< intervals
  std::atomic<bool> finish_{false};
  std::vector<std::thread> threads_;
};

}  // namespace rths::launch
