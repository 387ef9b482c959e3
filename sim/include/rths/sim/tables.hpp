// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace rths::sim {

/// Knots of the tabulated terms, as multiples of their range.
inline constexpr std::array<double, 9> kEvenKnots{-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1};
/// Knots of laws of velocity, which change most near zero.
inline constexpr std::array<double, 9> kDenseKnots{-1, -0.5, -0.2, -0.05, 0, 0.05, 0.2, 0.5, 1};

}  // namespace rths::sim
