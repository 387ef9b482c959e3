// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/bench/machine.hpp>

namespace rths::bench {

/// Times of the chosen processors since the start of the machine [s].
struct CpuTimes {
  double busy = 0;   ///< work of any process
  double idle = 0;   ///< waiting
  double steal = 0;  ///< ready, but the host ran another guest
};

/// Reads the processors' times from the text of /proc/stat.
/// @param ticks_per_second  unit of the numbers in the text [1/s]
[[nodiscard]] CpuTimes parse_cpu_times(const std::string& proc_stat, const Cpus& cpus,
                                       double ticks_per_second);

/// Share of the two processors' time that others used during a cycle.
struct Load {
  double other = 0;  ///< by other processes [-]
  double steal = 0;  ///< by the host [-]
};

/// A cycle is quiet up to this load of the two processors by others [-].
inline constexpr Load kQuiet{0.10, 0.02};
[[nodiscard]] bool is_quiet(const Load& load);

/// Load between two readings. @param own  processor time of our processes in between [s]
[[nodiscard]] Load load_between(const CpuTimes& before, const CpuTimes& after, double own);

/// Why a measurement is doubtful in which the host took too much time; empty: it took little.
[[nodiscard]] std::string steal_trouble(double steal);

/// Measures the load of the two processors since its construction.
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
