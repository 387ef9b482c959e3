// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <rths/identification/record.hpp>

namespace rths::diagnosis {

/// What moves in a section of a record that is taken for a section at rest; empty: nothing.
/// @param samples  the first, and the one behind the last   @param records  all of the case
[[nodiscard]] std::string motion_at_rest(const Record& record,
                                         std::pair<std::size_t, std::size_t> samples,
                                         const std::vector<Record>& records);

}  // namespace rths::diagnosis
