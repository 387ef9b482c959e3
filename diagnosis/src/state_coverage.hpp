// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "problem.hpp"

namespace rths::diagnosis {

/// The test that spreads most evenly over a state.
struct Widest {
  std::size_t test;   ///< of the problem of tests
  std::string state;  ///< "displacement and velocity"
};

/// Finds the test that visits best what a form of the residual depends on, over the range that the
/// records visited; nothing if tests cannot choose that state.
/// @param named  predicts outputs where they are the state
/// @param form  of a description: "sgn(v) g(u)"
[[nodiscard]] std::optional<Widest> widest(const Problem& records, const Problem& tests,
                                           const Hypothesis& named, const std::string& form);

}  // namespace rths::diagnosis
