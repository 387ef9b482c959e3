// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/cases/case.hpp>

namespace rths::diagnosis {

/// Checks the sections that a case states to be without motion: motion would count as noise.
/// @param tables  [[record]] of each record
/// @throws Error with the position of `quiet_s`, or of `use` of a reference   @setup
void refuse_motion_at_rest(const std::vector<Record>& records, const std::vector<Config>& tables);

/// Gives each section that begins where another section of its file ends, or within it, the other's
/// samples as its past: they drive the model and are not compared. A specimen keeps its damage and
/// its forces between two sections.
/// @param tables  of the records, in their order: [[record]]
void join_sections(std::vector<Record>& records, const std::vector<Config>& tables);

/// @throws Error with the position of a file that is fitted and held out at the same time   @setup
void refuse_overlap(const std::vector<Record>& records, const std::vector<Config>& tables);

}  // namespace rths::diagnosis
