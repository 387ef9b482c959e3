// SPDX-License-Identifier: Apache-2.0
#include "rank_watch.hpp"

#include <algorithm>
#include <chrono>
#include <map>
#include <thread>

#include <fmt/format.h>

#include "process_table.hpp"

namespace rths::adapters {
namespace {

constexpr auto kBetweenLooks = std::chrono::milliseconds{100};  // ten ticks of processor time

// As the runner of the script names the processes.
constexpr const char* kRank = "rank ";
constexpr const char* kStarts = " starts";

/// By name: in the order of the ranks.
std::map<std::string, Process> ranks_of(int launcher) {
  const auto all = processes();
  std::map<std::string, Process> ranks;
  for (const auto& [pid, process] : all)
    if (process.name.starts_with(kRank) && descends_from(pid, launcher, all))
      ranks[process.name] = process;
  return ranks;
}

const char* trouble_of(const Process& before, const Process& now) {
  if (now.state == 'T' || now.state == 't') return " is stopped by a signal";
  const bool is_idle = before.state != 'R' && now.state != 'R' && before.ticks == now.ticks;
  return is_idle ? " sleeps" : "";
}

}  // namespace

std::string hanging_ranks(int launcher) {
  const auto before = ranks_of(launcher);
  std::this_thread::sleep_for(kBetweenLooks);
  const auto now = ranks_of(launcher);
  const auto starts = [](const auto& rank) { return rank.first.ends_with(kStarts); };
  const bool all_start = std::all_of(now.begin(), now.end(), starts);
  std::string text;
  for (const auto& rank : now) {
    const auto& [name, process] = rank;
    const auto earlier = before.find(name);
    if (earlier == before.end()) continue;
    std::string trouble = trouble_of(earlier->second, process);
    if (starts(rank) && !all_start)
      trouble += fmt::format("{} has not begun to analyze", trouble.empty() ? "" : " and");
    if (!trouble.empty())
      text +=
          fmt::format("{}{}{}", text.empty() ? "" : ", ", name.substr(0, name.rfind(' ')), trouble);
  }
  return text;
}

}  // namespace rths::adapters
