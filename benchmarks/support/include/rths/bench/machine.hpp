// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rths::bench {

/// Trouble of a machine without a chosen pair of processors.
inline constexpr const char* kOneProcessor =
    "only one processor is available, a measurement needs two";

/// The two processors of a measurement.
struct Cpus {
  int near = 0;  ///< of the side that measures the time
  int far = 0;   ///< of the side that answers
};

/// Package and core of a processor.
struct CpuTopology {
  int cpu = 0;
  int package = 0;
  std::vector<int> siblings;  ///< processors of its core, including itself
};

struct Choice {
  Cpus cpus;
  bool siblings = false;  ///< the two share a core, so their data never leaves its cache
};

/// Chooses two processors of one package that share no core; two that do, if there are no others.
/// Avoids processor 0, which serves most interrupts.
/// @returns nothing if there are fewer than two processors
[[nodiscard]] std::optional<Choice> choose_cpus(std::vector<CpuTopology> cpus);

/// Reads a list of processors in the kernel's format: "0,2-4".
[[nodiscard]] std::vector<int> parse_cpu_list(std::string_view text);

/// Properties of the machine that affect the measurements.
struct Machine {
  std::string cpu;  ///< model name
  int processors = 0;
  std::optional<Choice> chosen;  ///< none on a machine with one processor
  std::string kernel;
  bool hypervisor = false;  ///< a guest: the host may move or stop its processors unnoticed
  std::string huge_pages;
};

/// Describes this machine and chooses two of the usable processors.   @setup
[[nodiscard]] Machine describe_machine();

}  // namespace rths::bench
