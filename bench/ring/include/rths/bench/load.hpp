// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/bench/machine.hpp>

namespace rths::bench {

/// Time that the chosen processors spent since the machine was started [s].
struct CpuTimes {
  double busy = 0;   ///< at work, whoever's it was
  double idle = 0;   ///< waiting
  double steal = 0;  ///< ready, while the host gave the processor to somebody else
};

/// Reads what the kernel says of the processors in /proc/stat.
/// @param ticks_per_second  unit of the numbers in the text [1/s]
[[nodiscard]] CpuTimes parse_cpu_times(const std::string& proc_stat, const Cpus& cpus,
                                       double ticks_per_second);

/// What others took of the two processors' time while a cycle was measured.
struct Load {
  double other = 0;  ///< work that was not ours [-]
  double steal = 0;  ///< taken by the host [-]
};

/// @param own  time that our processes were at work in between [s]
[[nodiscard]] Load load_between(const CpuTimes& before, const CpuTimes& after, double own);

/// Watches the two processors from its birth on.
class LoadMeter {
 public:
  explicit LoadMeter(const Cpus& cpus);
  [[nodiscard]] Load so_far() const;

 private:
  Cpus cpus_;
  CpuTimes before_;
  double own_before_;
};

}  // namespace rths::bench
