// SPDX-License-Identifier: Apache-2.0
#include "complaint.hpp"

#include <cstdio>
#include <mutex>
#include <new>
#include <set>
#include <string>

namespace rths::scramnet {

void complain_once(const char* where, const char* message) noexcept {
  static std::mutex mutex;
  static auto* said = new std::set<std::string>;  // outlives the clients' own destructors
  const std::lock_guard lock{mutex};
  try {
    if (!said->insert(where).second) return;
  } catch (const std::bad_alloc&) {  // said twice is better than not at all
  }
  std::fprintf(stderr, "scramnet: %s\n", message);
}

}  // namespace rths::scramnet
