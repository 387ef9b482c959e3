// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::experiment {

/// Refuses keys that no node of the experiment uses: the test would be the same without them.
/// Collects tables without an effect that other runs of the same file need as remarks.
/// @throws Error with the place and the name of the first such key   @setup
void check_uses(const Config& file, Experiment& experiment);

}  // namespace rths::experiment
