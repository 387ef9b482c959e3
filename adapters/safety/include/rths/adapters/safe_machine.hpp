// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/controller/safety.hpp>
#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// Words of an axis of the machine, by their role.
struct MachineAxis {
  std::string name;                 ///< "long", "lat"
  std::string reference;            ///< to the machine [m]
  std::string displacement, force;  ///< its measurements [m], [N]
};

struct SafeMachineSettings {
  controller::SafetySettings safety;
  std::vector<MachineAxis> axes;   ///< as many as `safety.axes`
  std::vector<std::string> nodes;  ///< that must step, and write no invalid value
  double watchdog = 0.6;           ///< longest silence of a node while running [s]
};

/// A machine behind a safety layer. No reference reaches the machine except through the layer,
/// whichever controller writes it. docs/safety.md states the behaviour.
///
/// Adds the parameter safety.stop, an input for each watched node, and the monitors safety.state,
/// safety.trip, safety.axis, safety.value and safety.limit. A trip or the operator's stop gives a
/// message at once; the step returns Fault when the machine is at rest.
/// @throws Error if a setting is out of range, or the machine lacks a word   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_safe_machine(std::unique_ptr<Adapter> machine,
                                                         const SafeMachineSettings& settings);

/// Puts the safety layer in front of a machine, unless the table says `enabled = false`.
/// @param machine  settings of the machine alone
/// @param words    of its axes, in the order long, lat, vert; none: those of the tested axes by
///                 role
/// @param table    [node.<name>.safety]: the file of the limits, and changes of them
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings with_safety(experiment::NodeSettings machine,
                                                   const Config& table,
                                                   const experiment::Experiment& setup,
                                                   const std::vector<MachineAxis>& words = {});

}  // namespace rths::adapters
