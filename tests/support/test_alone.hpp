// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::test {

/// Options of `rths run` for the hybrid test alone, a third of the time: it is repeated neither
/// without compensation nor under a second earthquake.
inline const std::vector<std::string> kTestAlone{"--set", "uncompensated={}", "--set",
                                                 "held_out={}"};

}  // namespace rths::test
