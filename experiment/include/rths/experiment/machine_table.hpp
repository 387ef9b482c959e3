// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include <rths/core/config.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::experiment {

/// Reads the [machine] table of an experiment: changed parameters of the SRMD, and terms.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] sim::TestMachine read_machine(const Config& table);

/// A key of a [machine] table, and what it sets in both axes.
struct MachineKey {
  const char* key;
  double sim::ServoAxis::*member;
};
[[nodiscard]] std::span<const MachineKey> machine_keys();

}  // namespace rths::experiment
