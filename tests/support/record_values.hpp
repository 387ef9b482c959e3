// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/core/error.hpp>
#include <rths/identification/record.hpp>

namespace rths::diagnosis::test_support {

/// Values of a record's channel. @throws Error if it has no such channel
[[nodiscard]] inline std::vector<double>& values_in(Record& record, const std::string& role) {
  for (auto& channel : record.channels)
    if (channel.role == role) return channel.values;
  throw Error{"no " + role};
}

}  // namespace rths::diagnosis::test_support
