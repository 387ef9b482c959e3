// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace rths::test {

/// Sample period of the controllers and machines in the tests [s].
inline constexpr double kPeriod = 0.001;

}  // namespace rths::test
