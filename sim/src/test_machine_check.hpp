// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/test_machine.hpp>

namespace rths::sim {

/// The specimen with the machine's motion terms in front of it.
/// @throws Error for a term that a machine cannot have   @setup
[[nodiscard]] Bearing mounted_specimen(const TestMachine& machine);

/// @param substep  of the integration [s]
/// @throws Error naming the parameter, its value and its bounds   @setup
void check(const TestMachine& machine, double substep);

}  // namespace rths::sim
