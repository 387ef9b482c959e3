// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "problem.hpp"

namespace rths::diagnosis {

/// Tests stay within what was visited times this: in amplitude, rate and acceleration.
inline constexpr double kReach = 1.25;

/// How the text of some of them begins.
inline constexpr const char* kNothingMoving = "nothing moving";
inline constexpr const char* kSameAgain = "the motion of";

/// A test that could be run: a record of its motion, without noise, and what to say of it. What
/// would be measured is not in it.
struct Design {
  std::string text;  ///< "sine of 0.5 Hz, ±120 mm, 30 s"
  Record record;
  bool is_empty = false;  ///< without the specimen
};

/// Tests of the catalogue that suit the channels which drive a relation; none if nothing does.
/// @param is_removable  there is a specimen that can be taken out of the machine
[[nodiscard]] std::vector<Design> designs_for(const Problem& problem, bool is_removable);

}  // namespace rths::diagnosis
