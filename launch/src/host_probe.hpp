// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <thread>
#include <vector>

#include <rths/core/clock.hpp>

#include "run_modes.hpp"

namespace rths::launch {

/// A thread on each processor of the run that does nothing but wake every millisecond and note how
/// late the host let it: what a run on this host cannot be blamed for. One processor may be stopped
/// while the others go on.
class HostProbe {
 public:
  explicit HostProbe(TimePoint epoch, double longest_run);
  ~HostProbe();
  HostProbe(const HostProbe&) = delete;
  HostProbe& operator=(const HostProbe&) = delete;

  /// Ends the threads. @returns the largest lateness of each 10 ms, of the processor that was
  /// latest
  [[nodiscard]] HostLateness finish();

 private:
  void run(int cpu, TimePoint epoch);
  std::vector<std::atomic<float>> largest_;  ///< of each interval, of all processors [s]
  std::atomic<std::size_t> used_{0};         ///< intervals
  std::atomic<bool> finish_{false};
  std::vector<std::thread> threads_;
};

}  // namespace rths::launch
