// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/experiment/experiment.hpp>
#include <rths/plant/large_plant.hpp>

namespace rths::session {

/// The large plant of an experiment. @throws Error if its plant is none   @setup
[[nodiscard]] const plant::LargePlant& large_plant_of(const experiment::Experiment& experiment);

}  // namespace rths::session
