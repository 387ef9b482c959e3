// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace rths::test {

/// True in `./lab test --full`, which makes the long trials.
inline bool is_long() { return std::getenv("RTHS_LONG") != nullptr; }

/// Repetitions of a trial. A sanitizer finds an error in the first ones, and takes several times as
/// long for each.
struct Repetitions {
  int in_a_long_run, usual, sanitized;

  [[nodiscard]] int count() const {
#ifdef RTHS_SANITIZED
    return is_long() ? in_a_long_run : sanitized;
#else
    return is_long() ? in_a_long_run : usual;
#endif
  }
};

}  // namespace rths::test
