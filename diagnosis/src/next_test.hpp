// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "investigation.hpp"

namespace rths::diagnosis {

/// Says what to run next, if a cause of the verdict is tied with others or something has no name.
///
/// Ties: the tests of the catalogue are predicted by those that are tied, as they were fitted, and
/// whitened by the noise of the records. What a test tells is the log-likelihood by which the one
/// beats the other on records and test together, beyond what it is on the records alone, the loser
/// fitted anew (to first order); the mean of both ways round. Unknown: the test that spreads most
/// evenly over the state that what is unexplained depends on.
void propose_next_test(const std::vector<std::unique_ptr<Investigation>>& all, const Case& c,
                       Verdict& verdict);

}  // namespace rths::diagnosis
