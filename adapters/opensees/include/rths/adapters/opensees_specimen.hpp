// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opensees_element.hpp>
#include <rths/adapters/opensees_script.hpp>
#include <rths/adapters/opf_layout.hpp>
#include <rths/core/config.hpp>
#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// A model in OpenSees that replaces controller, machine and specimen: an `element actuator` or
/// `element adapter` of its script moves it to the solver's targets and returns the force.
struct OpenSeesSpecimenSettings {
  /// The elements that move the model: name, port, protocol, units, axes. An `actuator` has one
  /// axis, an `adapter` one or several. In the order of the script, in which each element command
  /// waits for its connection.
  std::vector<OpenSeesElement> elements;
  OpfLayout layout;               ///< the block of the laboratory's map
  double simulation_step = 0.01;  ///< shortest time between arrivals [s]
  bool stops_time = false;        ///< virtual time: a step waits for OpenSees' answer
  OpenSeesScript script;
};

/// Reads [[element]] tables: see docs/opensees.md.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] std::vector<OpenSeesElement> read_specimen_elements(const Config& table);

/// Its steps are not @realtime, because they use sockets. StepData::message lives until the next
/// step.
/// @throws Error if the layout lacks an axis; on `activate`, if OpenSees does not connect   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_opensees_specimen(
    const OpenSeesSpecimenSettings& settings);

/// Keys: see docs/opensees.md. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_opensees_specimen_node(
    const std::string& node, const Config& table, const experiment::Experiment& experiment);

}  // namespace rths::adapters
