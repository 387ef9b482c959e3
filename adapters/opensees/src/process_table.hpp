// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

namespace rths::adapters {

/// A process of this host.
struct Process {
  int parent = 0, group = 0;
  std::string name;
  char state = 0;                ///< as proc(5): 'R' runs, 'S' sleeps, 'T' is stopped
  unsigned long long ticks = 0;  ///< of processor time
};

/// All processes of this host, by id. A process may end at any moment.
[[nodiscard]] std::map<int, Process> processes();

/// Whether a process is the ancestor, is in its group, or descends from such a process.
[[nodiscard]] bool descends_from(int pid, int ancestor, const std::map<int, Process>& all);

}  // namespace rths::adapters
