// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/experiment_design/proposal.hpp>
#include <rths/identification/problem.hpp>

namespace rths::diagnosis {

/// First words of the text of some tests.
inline constexpr const char* kNothingMoving = "no motion";
inline constexpr const char* kSameAgain = "the motion of";

/// A test that could be run: a record of its motion without noise, and its description. The record
/// contains no measurements.
struct Design {
  std::string text;  ///< "sine of 0.5 Hz, ±120 mm, 30 s"
  Record record;
  bool is_empty = false;  ///< no specimen in the machine
};

/// Tests of the catalogue for the channels that drive a relation; none if it has no driver.
/// @param is_removable  the machine has a specimen that can be removed
[[nodiscard]] std::vector<Design> designs_for(const Problem& problem, bool is_removable);

}  // namespace rths::diagnosis
