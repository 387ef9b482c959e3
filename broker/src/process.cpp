// SPDX-License-Identifier: Apache-2.0
#include "process.hpp"

#include <unistd.h>

#include <fstream>
#include <sstream>
#include <string>

namespace rths::broker {
namespace {

// Reads field 22 of /proc/<pid>/stat, counted from behind the command name, which may have spaces.
// A zombie counts as ended: its memory is released.
Claim claim_of(int pid) {
  std::ifstream file{"/proc/" + std::to_string(pid) + "/stat"};
  std::string line;
  if (!std::getline(file, line)) return 0;
  std::istringstream fields{line.substr(line.rfind(')') + 1)};
  std::string state;
  fields >> state;
  if (state == "Z" || state == "X") return 0;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  std::uint64_t started = 0;
  fields >> started;
  return started << 32 | static_cast<std::uint32_t>(pid);
}

}  // namespace

Claim own_claim() { return claim_of(getpid()); }

bool is_alive(Claim claim) { return claim != 0 && claim_of(pid_of(claim)) == claim; }

}  // namespace rths::broker
