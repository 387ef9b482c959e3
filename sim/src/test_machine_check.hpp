// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/test_machine.hpp>

namespace rths::sim {

/// The specimen behind the machine's motion terms.
/// @throws Error for a term that means nothing where it stands   @setup
[[nodiscard]] Bearing mounted_specimen(const TestMachine& machine);

/// @param part  of the integration [s]
/// @throws Error naming the parameter, its value and its bounds   @setup
void check(const TestMachine& machine, double part);

}  // namespace rths::sim
