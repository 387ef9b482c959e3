// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/machine.hpp>

#include <sched.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

namespace rths::bench {
namespace {

std::string content_of(const std::string& file) {
  std::ifstream stream{file};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

std::string first_line_of(const std::string& file) {
  const std::string content = content_of(file);
  return content.substr(0, content.find('\n'));
}

// The text behind the colon of a line of /proc that begins with `key`.
std::string field_of(const std::string& text, const std::string& key) {
  const auto line = ("\n" + text).find("\n" + key);
  if (line == std::string::npos) return "";
  const auto end = std::min(text.find('\n', line), text.size());
  const auto colon = text.find(':', line);
  if (colon >= end) return "";
  const auto begin = text.find_first_not_of(" \t", colon + 1);
  return begin >= end ? "" : text.substr(begin, end - begin);
}

std::vector<CpuTopology> usable_cpus() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  std::vector<CpuTopology> cpus;
  for (int cpu = 0; cpu < CPU_SETSIZE; ++cpu) {
    if (!CPU_ISSET(cpu, &allowed)) continue;
    const std::string folder = fmt::format("/sys/devices/system/cpu/cpu{}/topology/", cpu);
    const auto packages = parse_cpu_list(first_line_of(folder + "physical_package_id"));
    cpus.push_back({cpu, packages.empty() ? 0 : packages.front(),
                    parse_cpu_list(first_line_of(folder + "thread_siblings_list"))});
  }
  return cpus;
}

bool share_core(const CpuTopology& a, const CpuTopology& b) {
  return std::find(a.siblings.begin(), a.siblings.end(), b.cpu) != a.siblings.end();
}

std::string describe_huge_pages() {
  const auto setting = [](const char* file) {
    const std::string line =
        first_line_of(std::string{"/sys/kernel/mm/transparent_hugepage/"} + file);
    const auto open = line.find('[');
    const auto close = line.find(']');
    return close > open && close < line.size() ? line.substr(open + 1, close - open - 1)
                                               : std::string{"unknown"};
  };
  return fmt::format("transparent: {}, in shared memory: {}, reserved: {}", setting("enabled"),
                     setting("shmem_enabled"),
                     field_of(content_of("/proc/meminfo"), "HugePages_Total"));
}

}  // namespace

std::vector<int> parse_cpu_list(std::string_view text) {
  std::vector<int> cpus;
  const char* const end = text.data() + text.size();
  for (const char* at = text.data(); at < end; ++at) {
    int first = 0;
    const auto number = std::from_chars(at, end, first);
    if (number.ec != std::errc{}) break;
    at = number.ptr;
    int last = first;
    if (at < end && *at == '-') at = std::from_chars(at + 1, end, last).ptr;
    for (int cpu = first; cpu <= last; ++cpu) cpus.push_back(cpu);
  }
  return cpus;
}

std::optional<Choice> choose_cpus(std::vector<CpuTopology> cpus) {
  if (cpus.size() < 2) return std::nullopt;
  std::stable_partition(cpus.begin(), cpus.end(), [](const auto& p) { return p.cpu != 0; });
  std::optional<Choice> elsewhere;  // on another package: farther, but another core
  for (std::size_t a = 0; a < cpus.size(); ++a)
    for (std::size_t b = a + 1; b < cpus.size(); ++b) {
      if (share_core(cpus[a], cpus[b])) continue;
      const auto [near, far] = std::minmax(cpus[a].cpu, cpus[b].cpu);
      if (cpus[a].package == cpus[b].package) return Choice{{near, far}, false};
      if (!elsewhere) elsewhere = Choice{{near, far}, false};
    }
  if (elsewhere) return elsewhere;
  const auto [near, far] = std::minmax(cpus[0].cpu, cpus[1].cpu);
  return Choice{{near, far}, true};
}

Machine describe_machine() {
  const std::string cpuinfo = content_of("/proc/cpuinfo");
  utsname system{};
  uname(&system);
  Machine machine;
  machine.cpu = field_of(cpuinfo, "model name");
  if (machine.cpu.empty()) machine.cpu = system.machine;
  machine.processors = static_cast<int>(sysconf(_SC_NPROCESSORS_ONLN));
  machine.chosen = choose_cpus(usable_cpus());
  machine.kernel = system.release;
  machine.hypervisor = (field_of(cpuinfo, "flags") + " ").find(" hypervisor ") != std::string::npos;
  machine.huge_pages = describe_huge_pages();
  return machine;
}

}  // namespace rths::bench
