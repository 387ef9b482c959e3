// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/control_points.hpp>
#include <rths/adapters/opensees_element.hpp>
#include <rths/adapters/opensees_script.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/config.hpp>
#include <rths/experiment/node.hpp>

namespace rths::adapters {

struct OpenSeesSettings {
  std::vector<OpenSeesElement> elements;
  OpfLayout layout;  ///< the block of the laboratory's map
  /// Control points of the laboratory's OpenFresco script: see control_points.
  std::vector<std::string> trial_points, output_points;
  Handshake handshake = Handshake::AtTargetFirst;
  double simulation_step = 0.01;  ///< between targets [s]
  double integration_step = 0;    ///< of the script, in model time; 0: not checked [s]
  double rest = 0;                ///< before the first target [s]
  double wait_deadline = 1;       ///< for each flag of the handshake [s]
  /// Also steps on each message and ring write, not only on schedule; costs some busy waiting.
  bool is_prompt = false;
  bool stops_time = false;  ///< virtual time: a step waits for OpenSees' next request
  /// Draws the least time from the arrival of the specimen to the next trial [s]; empty: none.
  std::function<double()> computing_time;
  /// Acceleration of the ground at a time of the script: long, lat [m/s²]. For floors.
  std::function<std::array<double, 2>(double time)> ground;
  OpenSeesScript script;
};

/// Reads elements and control points of a node's table: see docs/opensees.md.
/// @param initial_stiffness  default, of one axis of the bearing [N/m]
/// @throws Error with the place of the first wrong value   @setup
void read_opensees(const Config& table, double initial_stiffness, OpenSeesSettings& settings);

/// Unmodified OpenSees as a node with OpenFresco's words and handshake. The node is the server of
/// each `genericClient` element of the script, for one OpenSees process. Targets go to the ring
/// when all elements have sent theirs; forces go back when the specimen is at its target. The node
/// covers OpenFresco's layers between element and ring: coordinates, set-up and control points.
///
/// Its steps are not @realtime, because they use sockets. StepData::message lives until the next
/// step. OpenSees starts when the ports are open and ends with the node.
/// @throws Error if the layout lacks a word that an element needs, or control points do not match
///         it; on `activate`, if a port is not available or OpenSees cannot start   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings);

/// Keys: see docs/opensees.md.
/// @param ideal  the node that takes the place of controller and machine when the solver runs again
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_opensees_node(const std::string& node,
                                                          const Config& table,
                                                          const experiment::Experiment& experiment,
                                                          const experiment::NodeSettings& ideal);

}  // namespace rths::adapters
