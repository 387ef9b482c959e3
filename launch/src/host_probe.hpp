// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <string>
#include <thread>

#include <rths/core/clock.hpp>

#include "run_parts.hpp"

namespace rths::launch {

/// A thread that does nothing but wake every millisecond and note how late the host let it: what a
/// run on this host cannot be blamed for.
class HostProbe {
 public:
  explicit HostProbe(TimePoint epoch, double longest_run);
  ~HostProbe();
  HostProbe(const HostProbe&) = delete;
  HostProbe& operator=(const HostProbe&) = delete;

  /// Ends the thread. @returns the largest lateness of each 10 ms
  [[nodiscard]] HostLateness finish();

 private:
  void run(TimePoint epoch);
  HostLateness lateness_;
  std::size_t used_ = 0;
  std::atomic<bool> finish_{false};
  std::thread thread_;
};

}  // namespace rths::launch
