// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/load.hpp>

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <iterator>
#include <sstream>

#include <fmt/format.h>

namespace rths::bench {
namespace {

// The columns of /proc/stat. The following columns of guest time are included in user and nice.
enum Column { kUser, kNice, kSystem, kIdle, kIoWait, kIrq, kSoftIrq, kSteal, kColumns };

CpuTimes times_now(const Cpus& cpus) {
  std::ifstream file{"/proc/stat"};
  const std::string text{std::istreambuf_iterator<char>{file}, {}};
  return parse_cpu_times(text, cpus, static_cast<double>(sysconf(_SC_CLK_TCK)));
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

// Processor time of this process and of its children that have ended [s].
double own_time() {
  double sum = 0;
  for (const auto who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
    rusage usage{};
    getrusage(who, &usage);
    sum += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  }
  return sum;
}

}  // namespace

CpuTimes parse_cpu_times(const std::string& proc_stat, const Cpus& cpus, double ticks_per_second) {
  CpuTimes sum;
  std::istringstream lines{proc_stat};
  for (std::string line; std::getline(lines, line);) {
    std::istringstream fields{line};
    std::string name;
    fields >> name;
    if (name != "cpu" + std::to_string(cpus.near) && name != "cpu" + std::to_string(cpus.far))
      continue;
    std::array<double, kColumns> ticks{};
    for (double& column : ticks) fields >> column;
    for (const auto column : {kUser, kNice, kSystem, kIrq, kSoftIrq}) sum.busy += ticks[column];
    sum.idle += ticks[kIdle] + ticks[kIoWait];
    sum.steal += ticks[kSteal];
  }
  return {sum.busy / ticks_per_second, sum.idle / ticks_per_second, sum.steal / ticks_per_second};
}

Load load_between(const CpuTimes& before, const CpuTimes& after, double own) {
  const double busy = after.busy - before.busy;
  const double steal = after.steal - before.steal;
  const double all = busy + steal + after.idle - before.idle;
  if (all <= 0) return {};
  return {std::max(0.0, busy - own) / all, steal / all};
}

bool is_quiet(const Load& load) { return load.other <= kQuiet.other && load.steal <= kQuiet.steal; }

std::string steal_trouble(double steal) {
  if (steal <= kQuiet.steal) return "";
  return fmt::format("the host used {:.1f} % of the processors' time, expected at most {:g} %",
                     100 * steal, 100 * kQuiet.steal);
}

LoadMeter::LoadMeter(const Cpus& cpus)
    : cpus_{cpus}, before_{times_now(cpus)}, own_before_{own_time()} {}

Load LoadMeter::so_far() const {
  return load_between(before_, times_now(cpus_), own_time() - own_before_);
}

}  // namespace rths::bench
