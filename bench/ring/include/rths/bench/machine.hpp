// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rths::bench {

/// The two processors that a measurement runs on.
struct Cpus {
  int near = 0;  ///< of the side that takes the time
  int far = 0;   ///< of the side that answers
};

/// Where a processor sits.
struct CpuPlace {
  int cpu = 0;
  int package = 0;
  std::vector<int> siblings;  ///< processors that share its core, itself among them
};

struct Choice {
  Cpus cpus;
  bool siblings = false;  ///< the two share a core: what they exchange never leaves its cache
};

/// Two processors of one package that share no core; two that do, if there are no others.
/// Processor 0, which serves most interrupts, is left alone if there is a choice.
/// @returns nothing if there are fewer than two
[[nodiscard]] std::optional<Choice> choose_cpus(std::vector<CpuPlace> places);

/// "0,2-4" as the kernel writes lists of processors.
[[nodiscard]] std::vector<int> parse_cpu_list(std::string_view text);

/// What numbers measured here depend on.
struct Machine {
  std::string cpu;  ///< as the processor calls itself
  int processors = 0;
  std::optional<Choice> chosen;  ///< none: there is one processor only
  std::string kernel;
  bool hypervisor = false;  ///< a guest: the host may move or stop its processors unseen
  std::string huge_pages;
};

/// This machine, and which two of the processors that we may use were chosen.   @setup
[[nodiscard]] Machine describe_machine();

/// As one JSON object, or as two lines for people.
[[nodiscard]] std::string to_json(const Machine& machine);
[[nodiscard]] std::string to_text(const Machine& machine);

}  // namespace rths::bench
