// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/adapters/numerical.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::adapters {

/// What computes the targets: the plant of the settings, or their displacement history. Both have
/// the interface of the plant.
/// @throws Error if the model cannot be assembled, or the history is not one   @setup
[[nodiscard]] std::unique_ptr<sim::Substructure> make_substructure(
    const NumericalSettings& settings);

}  // namespace rths::adapters
