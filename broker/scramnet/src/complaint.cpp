// SPDX-License-Identifier: Apache-2.0
#include "complaint.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#include <mutex>

namespace rths::scramnet {

void complain_once(const char* where, const char* message) noexcept {
  static std::mutex mutex;
  static std::array<const char*, 16> said{};
  const std::lock_guard lock{mutex};
  for (const char*& entry : said) {
    if (entry != nullptr && std::strcmp(entry, where) == 0) return;
    if (entry != nullptr) continue;
    entry = where;
    break;
  }
  std::fprintf(stderr, "scramnet: %s\n", message);
}

}  // namespace rths::scramnet
