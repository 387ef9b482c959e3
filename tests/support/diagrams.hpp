// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::test {

/// A diagram of a controller that only writes 0 to one signal.
inline std::string zero_diagram(const std::string& signal) {
  return R"(diagram = 1
base_rate_Hz = 1000
[[block]]
name = "zero"
type = "constant"
[[block]]
name = "flag"
type = "ring_output"
in.in = "zero"
signal = ")" +
         signal + "\"\n";
}

}  // namespace rths::test
