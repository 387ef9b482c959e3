// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/sim/machine/platen_machine.hpp>

#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::test {

/// The SRMD's file, with an empty table and no noise.
inline sim::machine::PlatenMachine srmd_machine_file() {
  auto machine =
      sim::machine::read_platen_machine(Config::load(source_tree() / "sim/machines/srmd.toml"));
  machine.has_specimen = false;
  auto& t = machine.transducers;
  t.displacement_noise = t.rotation_noise = t.force_noise = t.vertical_force_noise = 0;
  t.moment_noise = t.acceleration_noise = 0;
  return machine;
}

/// The same with the paper's lead-rubber bearing.
inline sim::machine::PlatenMachine srmd_machine_with_bearing() {
  auto machine = srmd_machine_file();
  machine.has_specimen = true;
  machine.specimen = plain_lead_rubber();
  return machine;
}

}  // namespace rths::test
