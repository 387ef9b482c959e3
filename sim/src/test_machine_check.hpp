// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include <rths/sim/test_machine.hpp>

namespace rths::sim {

/// A mass that moves with the platen: added to it, and no force of its own.
inline constexpr std::string_view kPlatenInertia = "platen_inertia";

/// The specimen behind the machine's motion terms.
/// @throws Error for a term that means nothing where it stands   @setup
[[nodiscard]] Bearing mounted_specimen(const TestMachine& machine);

/// @param part  of the integration [s]
/// @throws Error naming the parameter, its value and its bounds   @setup
void check(const TestMachine& machine, double part);

}  // namespace rths::sim
