// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths {

/// Standard acceleration of gravity [m/s²]. Source: CGPM 1901.
inline constexpr double kStandardGravity = 9.80665;

}  // namespace rths
