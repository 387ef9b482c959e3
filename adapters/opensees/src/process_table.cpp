// SPDX-License-Identifier: Apache-2.0
#include "process_table.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>

namespace rths::adapters {
namespace {

namespace fs = std::filesystem;

constexpr int kGroupField = 5, kUserTimeField = 14;  // of proc(5), stat

bool is_number(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

std::map<int, Process> processes() {
  std::map<int, Process> all;
  std::error_code ended;
  for (const auto& entry : fs::directory_iterator{"/proc", ended}) {
    const std::string pid = entry.path().filename().string();
    if (!is_number(pid)) continue;
    std::ifstream file{entry.path() / "stat"};
    std::string text;
    std::getline(file, text);
    const auto open = text.find('('), close = text.rfind(')');
    if (close == std::string::npos) continue;
    Process process;
    process.name = text.substr(open + 1, close - open - 1);
    std::istringstream fields{text.substr(close + 1)};
    fields >> process.state >> process.parent >> process.group;
    std::string other;
    for (int i = kGroupField + 1; i < kUserTimeField; ++i) fields >> other;
    unsigned long long user = 0, system = 0;
    fields >> user >> system;
    process.ticks = user + system;
    all[std::stoi(pid)] = process;
  }
  return all;
}

bool descends_from(int pid, int ancestor, const std::map<int, Process>& all) {
  constexpr int kDeepest = 1000;
  for (int depth = 0; pid > 0 && depth < kDeepest; ++depth) {
    if (pid == ancestor) return true;
    const auto process = all.find(pid);
    if (process == all.end()) return false;
    if (process->second.group == ancestor) return true;
    pid = process->second.parent;
  }
  return false;
}

}  // namespace rths::adapters
