// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opensees_element.hpp>
#include <rths/adapters/opensees_script.hpp>
#include <rths/adapters/opf_layout.hpp>
#include <rths/core/config.hpp>

namespace rths::adapters {

/// A model in OpenSees in the place of controller, machine and specimen: `element actuator` or
/// `element adapter` of its script holds it where a solver's targets say, and tells the force.
struct OpenSeesSpecimenSettings {
  /// What moves it: name, port, protocol, units, axes. An `actuator` has one, an `adapter` as many
  /// as it lists. In the order of the script: each of its commands waits for us.
  std::vector<OpenSeesElement> elements;
  OpfLayout layout;               ///< the block of the laboratory's map
  double simulation_step = 0.01;  ///< from one arrival to the next, at least [s]
  bool stops_time = false;        ///< time is virtual: a step takes until OpenSees has answered
  OpenSeesScript script;
};

/// Reads [[element]] tables: see docs/opensees.md.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] std::vector<OpenSeesElement> read_specimen_elements(const Config& table);

/// It uses sockets: its steps are not @realtime. StepData::message lives until the next step.
/// @throws Error if the layout lacks an axis; on `activate`, if OpenSees does not come   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_opensees_specimen(
    const OpenSeesSpecimenSettings& settings);

}  // namespace rths::adapters
