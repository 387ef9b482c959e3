// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/core/config.hpp>
#include <rths/experiment/parts.hpp>

namespace rths::experiment {

/// Reads [model]. Its tables `specimen` and `machine` hold the differences between model and
/// laboratory; `fitted` lists the fitted parameters. The files of `improvement` hold tables of the
/// same names, which override these.
/// @param specimen  the bearing with the changes of [specimen]
/// @param machine  [machine]
/// @param axial_load  on the bearing [N]
/// @throws Error with the place of the first wrong key or value   @setup
[[nodiscard]] AssumedModel read_assumed_model(const Config& model, const Config& specimen,
                                              const Config& machine, double axial_load);

}  // namespace rths::experiment
