// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rths/adapters/adapter.hpp>
#include <rths/core/config.hpp>

namespace rths::adapters {

/// A degree of freedom of an element, and the signals that it is on the ring.
struct OpenSeesDof {
  std::string displacement;      ///< target, written
  std::string velocity;          ///< of the target; empty: not told
  std::string force;             ///< restoring, read
  bool is_rotation = false;      ///< then of rad and N·m
  double displacement_unit = 1;  ///< of the script [m, rad]
  double force_unit = 1;         ///< of the script [N, N·m]
};

/// One `element genericClient` of a script.
struct OpenSeesElement {
  std::string name;
  bool is_udp = false;
  std::string address = "127.0.0.1";
  std::uint16_t port = 8090;
  std::vector<OpenSeesDof> dofs;  ///< as the script lists them
  /// In the units of the script, n × n.
  Eigen::MatrixXd initial_stiffness, damping, mass;
};

struct OpenSeesSettings {
  std::vector<OpenSeesElement> elements;
  double rest = 0;               ///< before the first target [s]
  double wait_deadline = 1;      ///< for each flag of the handshake [s]
  double connect_deadline = 60;  ///< for OpenSees to come, on the host's clock [s]
  double answer_deadline = 10;   ///< for OpenSees to say something, on the host's clock [s]
  /// Steps come with the news, not only when they are due: at the price of some waiting awake.
  bool is_prompt = false;
  bool stops_time = false;  ///< time is virtual: a step takes until OpenSees has said what is next
  /// OpenSees itself, to be started here: program, script and arguments. Empty: somebody else does.
  std::vector<std::string> command;
  std::filesystem::path log;  ///< what it says goes there
  /// Written before it starts: path, content.
  std::vector<std::pair<std::filesystem::path, std::string>> files;
};

/// Reads [[element]] tables: see docs/opensees.md.
/// @param initial_stiffness  of one axis of the bearing, where a table states none [N/m]
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] std::vector<OpenSeesElement> read_opensees_elements(const Config& table,
                                                                  double initial_stiffness);

/// OpenSees, unmodified, as a node that speaks OpenFresco's words and handshake: each element of a
/// script that is a `genericClient` finds its server here. A target goes to the ring when all
/// elements have theirs; forces are answered when the specimen has arrived. One OpenSees process.
///
/// It uses sockets: its steps are not @realtime. Step::message lives until the next step.
/// It is started when the ports are open, and ends with us.
/// @throws Error if a port cannot be had or OpenSees not be started: on `activate`   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_opensees(const OpenSeesSettings& settings);

}  // namespace rths::adapters
