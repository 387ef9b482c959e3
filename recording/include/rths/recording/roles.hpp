// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/recording.hpp>

namespace rths::recording {

/// Signals of one horizontal axis of a test, by their role. Each is a full name.
struct AxisRoles {
  std::string axis;                 ///< "long", "lat"
  std::string target;               ///< displacement that the solver asks for [m]
  std::string command;              ///< displacement that the controller asks for, every tick [m]
  std::string displacement, force;  ///< measured, as the controller compares and returns them
  std::string reference, reference_echo;  ///< to the machine; as it received it [m]
  std::string machine_displacement, machine_acceleration, machine_force;  ///< its measurements
  std::string returned_displacement, returned_force;                      ///< to the solver
};

/// Nodes and signals of a test by their role. Reports and diagnoses use roles, so they work with
/// the map of any laboratory. The table [roles] of a map or of an experiment binds them; the
/// defaults are the words of the SRMD.
struct Roles {
  std::string solver, controller, machine;                   ///< nodes
  std::string new_target, time;                              ///< flag; model time of the target [s]
  std::string load, load_reference, vertical_force;          ///< of the specimen, vertical [N]
  std::string vertical_command, vertical_measured;           ///< force of a vertical controller [N]
  std::vector<AxisRoles> axes;                               ///< the tested ones: long, lat
  [[nodiscard]] std::string monitor_of_controller() const {  ///< begin of its monitors' names
    return "monitor." + controller + ".";
  }
};

/// The table [roles] of the map of a run, in its recording.
inline constexpr const char* kMapRolesText = "map_roles";

/// An experiment whose [roles] also has those of its map. Its own have priority.   @setup
[[nodiscard]] Config with_map_roles(const Config& experiment, const Config& map_roles);

/// Reads [roles] of an experiment. The default of a node's role is the first node with a suitable
/// adapter, then the SRMD's name.
/// @throws Error with the place of the first wrong key   @setup
[[nodiscard]] Roles read_roles(const Config& experiment);

/// The first node, of the tables [node.…], with one of the adapters.   @setup
[[nodiscard]] std::optional<std::string> node_with(const Config& nodes,
                                                   const std::vector<std::string>& adapters);

/// Checks that a map has the signals and nodes that [roles] names.
/// @throws Error with the place of the first that is missing   @setup
void check_roles(const Config& roles, const memmap::Map& map);

/// The changes of the run's command line, key and value, in their order.   @setup
[[nodiscard]] std::vector<KeyValue> overrides_of(const Reader& run);

/// The path of the run's experiment file; empty: the recording names none.   @setup
[[nodiscard]] std::string experiment_path(const Reader& run);

/// The recorded experiment with the changes of its command line; empty if the recording holds none.
/// @setup
[[nodiscard]] std::optional<Config> recorded_experiment(const Reader& run);

/// The recorded experiment with the roles of its map and the changes of its command line; empty if
/// the recording holds none.
/// @setup
[[nodiscard]] std::optional<Config> experiment_in(const Reader& run);

/// Roles of a run. Where the controller records no command or measurement, the words that machine
/// and solver exchange take their place.
/// @throws Error as read_roles   @setup
[[nodiscard]] Roles roles_of(const Reader& run);

}  // namespace rths::recording
