// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/plant/factor.hpp>

namespace rths::plant {

/// Modes of K φ = ω² M φ, lowest first.
struct StructureModes {
  VectorXd frequencies;  ///< [Hz]
  MatrixXd shapes;       ///< dof × mode; ΦᵀMΦ = 1
};

/// @param factor  of K
/// @param mass    lumped [kg]
/// @throws Error if they are not found to 1e-8   @setup
[[nodiscard]] StructureModes lowest_modes(Factor& factor, const VectorXd& mass, Index count);

/// All modes up to a frequency, and the first one above it.
/// @throws Error as lowest_modes, or if there are more than half of the degrees of freedom   @setup
[[nodiscard]] StructureModes modes_up_to(Factor& factor, const VectorXd& mass, double frequency);

}  // namespace rths::plant
