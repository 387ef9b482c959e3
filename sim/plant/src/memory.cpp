// SPDX-License-Identifier: Apache-2.0
#include "memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::plant {
namespace {

constexpr double kMega = 1e6, kKibi = 1024;

std::optional<double> first_number(const char* file) {
  std::ifstream in{file};
  double value = 0;
  return in >> value ? std::optional{value} : std::nullopt;
}

double of_machine() {
  std::ifstream in{"/proc/meminfo"};
  std::string name, unit;
  for (double kibibytes = 0; in >> name >> kibibytes; std::getline(in, unit))
    if (name == "MemAvailable:") return kKibi * kibibytes;
  return INFINITY;
}

double of_control_group() {
  const auto most = first_number("/sys/fs/cgroup/memory.max"),
             used = first_number("/sys/fs/cgroup/memory.current");
  return most && used ? *most - *used : INFINITY;
}

double of_process() {
  rlimit limit{};
  const auto pages = first_number("/proc/self/statm");
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || !pages)
    return INFINITY;
  return static_cast<double>(limit.rlim_cur) - *pages * static_cast<double>(sysconf(_SC_PAGESIZE));
}

}  // namespace

double available_memory() {
  return std::max(0.0, std::min({of_machine(), of_control_group(), of_process()}));
}

void require_memory(const std::string& what, double bytes) {
  const double available = available_memory();
  if (bytes > available)
    throw Error{fmt::format("{} needs {:.0f} MB of memory, but {:.0f} MB are available", what,
                            bytes / kMega, available / kMega)};
}

}  // namespace rths::plant
