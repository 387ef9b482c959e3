// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/machine/platen_machine.hpp>

namespace rths::sim::machine {

/// Substeps of at most 0.1 ms. @throws Error if the period is not positive   @setup
[[nodiscard]] int substeps_of(double period);

/// @param substep  of the integration [s]
/// @throws Error if the machine or its specimen is too fast for the substeps, an actuator does not
///         reach the limits of the platen, or the specimen's load is beyond the machine's   @setup
void check(const PlatenMachine& machine, double substep);

}  // namespace rths::sim::machine
