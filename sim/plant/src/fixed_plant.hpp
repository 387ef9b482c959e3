// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/plant/basis.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::plant {

/// The basis of the same structure with its bearing nodes fixed: its modes alone.   @setup
[[nodiscard]] Basis fixed_basis(const Structure& structure, double frequency_limit);

/// A structure on a fixed base: each mode an oscillator, solved exactly for ground acceleration
/// linear between samples. Its targets are 0.
/// @param damping_time  a₁ [s]   @setup
[[nodiscard]] std::unique_ptr<sim::Substructure> make_fixed(const Basis& basis,
                                                            const sim::GroundMotion& motion,
                                                            double time_step, double damping_time);

}  // namespace rths::plant
