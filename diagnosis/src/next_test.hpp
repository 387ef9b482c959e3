// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "investigation.hpp"

namespace rths::diagnosis {

/// Proposes the next test, if a cause of the verdict is tied with others or the residual has no
/// name.
///
/// Ties: the tied candidates, as fitted, predict the tests of the catalogue. Their predictions are
/// whitened with the noise of the records. A test is scored by its expected log-likelihood gain for
/// the true candidate of two: on records and test together, less the gain on the records alone,
/// with the wrong candidate refitted to first order. The score is the mean of both cases. Unknown:
/// the test that covers most evenly the state on which the residual depends.
void propose_next_test(const std::vector<std::unique_ptr<Investigation>>& all, const Case& c,
                       Verdict& verdict);

}  // namespace rths::diagnosis
