// SPDX-License-Identifier: Apache-2.0
#include "warning.hpp"

#include <array>
#include <cstdio>
#include <cstring>
#include <mutex>

namespace rths::scramnet {

void warn_once(const char* where, const char* message) noexcept {
  static std::mutex mutex;
  static std::array<const char*, 16> warned{};
  const std::lock_guard lock{mutex};
  for (const char*& entry : warned) {
    if (entry != nullptr && std::strcmp(entry, where) == 0) return;
    if (entry != nullptr) continue;
    entry = where;
    break;
  }
  std::fprintf(stderr, "scramnet: %s\n", message);
}

}  // namespace rths::scramnet
