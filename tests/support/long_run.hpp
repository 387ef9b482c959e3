// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>

namespace rths::test {

/// True in `./lab test --full`, which makes the long trials.
inline bool is_long() { return std::getenv("RTHS_LONG") != nullptr; }

}  // namespace rths::test
