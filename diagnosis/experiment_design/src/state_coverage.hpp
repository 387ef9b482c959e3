// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include <rths/identification/problem.hpp>

namespace rths::diagnosis {

/// The test that covers a state most evenly.
struct Widest {
  std::size_t test;   ///< of the problem of tests
  std::string state;  ///< "displacement and velocity"
};

/// Finds the test that covers most evenly the state on which a form of the residual depends, over
/// the range of the records; nothing if tests cannot choose that state.
/// @param named  predicts the outputs if they are the state
/// @param form  of a description: "sgn(v) g(u)"
[[nodiscard]] std::optional<Widest> widest(const Problem& records, const Problem& tests,
                                           const Hypothesis& named, const std::string& form);

}  // namespace rths::diagnosis
