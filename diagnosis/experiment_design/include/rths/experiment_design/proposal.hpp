// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <rths/identification/relation_findings.hpp>

namespace rths::diagnosis {

/// Factor on the recorded amplitude, rate and acceleration that limits proposed tests.
inline constexpr double kReach = 1.25;

/// The commanded motion of a test.
struct TestMotion {
  double time_step = 0;                                               ///< [s]
  std::vector<std::pair<std::string, std::vector<double>>> channels;  ///< by role [SI]
};

/// A test that separates a named candidate from one that is tied with it.
struct SeparatingTest {
  const SelectionRound* round;  ///< of the named candidate
  std::size_t tied;             ///< index of the other one in SelectionRound::tied
  std::string text;
  double sigma = 0;  ///< separation [standard deviations]
};

/// Tests are sought for so many candidates of a tie, those with the fewest parameters.
inline constexpr std::size_t kMostRivals = 3;

/// The proposed next test.
struct TestProposal {
  std::string text;  ///< empty: none
  TestMotion motion;
  std::vector<SeparatingTest> separating;          ///< best test of each pair that a test separates
  std::vector<const SelectionRound*> inseparable;  ///< no known test separates their ties
};

/// Proposes the next test, if a named candidate is tied with others or the residual has no name.
///
/// Ties: the tied candidates, as fitted, predict the tests of the catalogue. Their predictions are
/// whitened with the noise of the records. A test is scored by its expected log-likelihood gain for
/// the true candidate of two: on records and test together, less the gain on the records alone,
/// with the wrong candidate refitted to first order. The score is the mean of both cases. Unknown:
/// the test that covers most evenly the state on which the residual depends.
/// @param is_bearing  the specimen is a bearing, which the laboratory can remove
/// @param is_unknown  no candidate is named that explains the residual
[[nodiscard]] TestProposal propose_test(const std::vector<std::unique_ptr<RelationFindings>>& all,
                                        bool is_bearing, bool is_unknown);

}  // namespace rths::diagnosis
