// SPDX-License-Identifier: Apache-2.0
#include "process.hpp"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace rths::broker {
namespace {

std::string folder_of(Claim claim) { return "/proc/" + std::to_string(pid_of(claim)); }

// A line is "begin-end permissions offset major:minor inode path", with hexadecimal device numbers.
bool is_mapping_of(const std::string& line, const ObjectId& object) {
  std::istringstream fields{line};
  std::string skipped;
  unsigned device_major = 0;
  unsigned device_minor = 0;
  char colon = ' ';
  ino_t inode = 0;
  fields >> skipped >> skipped >> skipped >> std::hex >> device_major >> colon >> device_minor >>
      std::dec >> inode;
  return fields && inode == object.inode && makedev(device_major, device_minor) == object.device;
}

// Empty if this user may not see the mappings of the process.
std::optional<bool> has_mapped(Claim claim, const ObjectId& object) {
  std::ifstream file{folder_of(claim) + "/maps"};
  if (!file) return std::nullopt;
  for (std::string line; std::getline(file, line);)
    if (is_mapping_of(line, object)) return true;
  return false;
}

std::optional<uid_t> user_of(Claim claim) {
  std::ifstream file{folder_of(claim) + "/status"};
  for (std::string word; file >> word;) {
    uid_t user = 0;
    if (word == "Uid:" && file >> user) return user;
  }
  return std::nullopt;
}

// The first process of a host is none of a ring, but of a container it may be: there it can be
// seen.
bool may_write(Claim claim, const ObjectId& object) {
  const auto user = user_of(claim);
  if (!user || pid_of(claim) == 1) return false;
  return *user == object.owner || *user == 0 || (object.mode & (S_IWGRP | S_IWOTH)) != 0;
}

}  // namespace

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

Claim own_claim() { return claim_of(getpid()); }

bool is_on(Claim claim, const ObjectId& object) {
  if (!is_alive(claim)) return false;
  const auto mapped = has_mapped(claim, object);
  return mapped ? *mapped : may_write(claim, object);
}

bool is_alive(Claim claim) { return claim != 0 && claim_of(pid_of(claim)) == claim; }

}  // namespace rths::broker
