// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/control_points.hpp>
#include <rths/adapters/opensees_element.hpp>
#include <rths/adapters/opensees_script.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/config.hpp>

namespace rths::adapters {

struct OpenSeesSettings {
  std::vector<OpenSeesElement> elements;
  OpfLayout layout;  ///< the block of the laboratory's map
  /// Control points, as the laboratory's OpenFresco script has them: see control_points.
  std::vector<std::string> trial_points, output_points;
  Handshake handshake = Handshake::AtTargetFirst;
  double simulation_step = 0.01;  ///< from target to target [s]
  double rest = 0;                ///< before the first target [s]
  double wait_deadline = 1;       ///< for each flag of the handshake [s]
  /// Steps come with the news, not only when they are due: at the price of some waiting awake.
  bool is_prompt = false;
  bool stops_time = false;  ///< time is virtual: a step takes until OpenSees has said what is next
  OpenSeesScript script;
};

/// Reads what a node's table says of elements and control points: see docs/opensees.md.
/// @param initial_stiffness  of one axis of the bearing, where a table states none [N/m]
/// @throws Error with the place of the first wrong value   @setup
void read_opensees(const Config& table, double initial_stiffness, OpenSeesSettings& settings);

/// OpenSees, unmodified, as a node that speaks OpenFresco's words and handshake: each element of a
/// script that is a `genericClient` finds its server here. A target goes to the ring when all
/// elements have theirs; forces are answered when the specimen has arrived. One OpenSees process.
/// What OpenFresco has between element and ring, coordinates, set-up and control points, is here.
///
/// It uses sockets: its steps are not @realtime. StepData::message lives until the next step.
/// It is started when the ports are open, and ends with us.
/// @throws Error if the layout lacks a word that an element needs, or control points do not fit it;
///         on `activate`, if a port cannot be had or OpenSees not be started   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings);

}  // namespace rths::adapters
