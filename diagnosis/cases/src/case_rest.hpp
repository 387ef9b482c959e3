// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// Checks the sections that a case states to be without motion: motion would count as noise.
/// @param tables  [[record]] of each record
/// @throws Error with the position of `quiet_s`, or of `use` of a reference   @setup
void refuse_motion_at_rest(const std::vector<Record>& records, const std::vector<Config>& tables);

}  // namespace rths::diagnosis
