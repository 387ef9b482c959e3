// SPDX-License-Identifier: Apache-2.0
#include <rths/core/error.hpp>

#include <cstdio>
#include <cstdlib>

namespace rths {

void assertion_failed(const char* claim, const char* file, int line) noexcept {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, claim);
  std::abort();
}

}  // namespace rths
