// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/adapter_runner.hpp>
#include <rths/adapters/test_setup.hpp>
#include <rths/adapters/user_program.hpp>
#include <rths/core/config.hpp>
#include <rths/memmap/map.hpp>

namespace rths::adapters {

/// Task of a node in the test. Nodes start in this order: receivers before senders.
enum class Role {
  Recorder,
  Machine,
  Controller,
  Solver,  ///< its Done ends the test
};

/// The run and the node for which an adapter is built.
struct NodeContext {
  std::string node;
  Duration period{0};  ///< of its steps
  bool is_virtual = false;
  std::filesystem::path recording;  ///< other files of the node lie beside it
  const memmap::Map& map;  ///< the laboratory's; of NodeSettings::monitors: the whole ring's
  /// For the recording: input files and properties of the run by name, periods of all nodes.
  std::vector<std::pair<std::string, std::string>> config, meta;
  std::map<std::string, Duration> periods;
  std::vector<std::string> watched;  ///< solvers and controllers with monitors of their own
};

/// What the table [machine] means to a node.
enum class MachineTable {
  Unused,
  Model,     ///< only the model in the diagnosis: the machine is the user's own
  Carriage,  ///< only what the platen carries, `empty_table` and `rollers`: its file has the rest
  Whole,
};

/// Settings of a node, from its table of the experiment.
struct NodeSettings {
  Role role = Role::Machine;
  Schedule schedule;              ///< unless the table states another
  int priority = 30;              ///< of its real-time thread, 1…60
  bool keeps_times = false;       ///< the recording has start and duration of each step
  double start_deadline = 0;      ///< to become ready, beyond the time that every node has [s]
  bool integrates_plant = false;  ///< α-OS of the experiment's plant, which a budget repeats
  /// Of a solver with a structure of its own that can run again: the node that then takes the place
  /// of controller and machine, for the purely numerical result. Null: it cannot.
  std::shared_ptr<const NodeSettings> ideal_machine;
  bool may_not_end = false;  ///< a solver of the user's own: the launcher ends a late run
  MachineTable machine_table = MachineTable::Unused;
  bool has_computing_time = false;  ///< modelled by keys of [solver]
  bool waits_for_flags = false;     ///< of the handshake, at most `wait_deadline_s` of [solver]
  std::filesystem::path diagram;    ///< block diagram that it runs, if any
  std::filesystem::path constants;  ///< values that replace those of the diagram's blocks, if any
  Config blocks;                    ///< the same in the experiment, with priority
  bool lacks_safety = false;        ///< a machine whose commands pass no safety layer
  double longest_stop = 0;          ///< of its safety layer [s]; 0: that of the retreat
  /// Its files, for the recording: name, and content or SHA-256. May be empty. @throws Error
  std::function<std::vector<std::pair<std::string, std::string>>()> texts;
  std::string target_count;  ///< monitor that counts its targets; empty: their time counts them
  std::string motion_fault;  ///< why it cannot run under another motion; empty: it can
  /// Monitors of an adapter that is built after the others, when the map of the ring is complete.
  std::optional<std::vector<Port>> monitors;
  /// The node is this program of the user's own; then `make` may be empty.
  std::optional<UserProgram> program;
  /// Checks requirements of the host, such as programs; may be empty. @throws Error   @setup
  std::function<void()> check;
  /// @throws Error   @setup
  std::function<std::unique_ptr<Adapter>(const TestSetup&, const NodeContext&)> make;
};

/// A kind of adapter, by its name in an experiment.
struct Factory {
  const char* name;
  /// Reads the table of a node. The launcher reads host, period_s, phase_s and tune, and rejects
  /// unknown keys.
  /// @throws Error with the place of the first wrong value   @setup
  NodeSettings (*read)(const std::string& node, const Config& table, const TestSetup& setup);
};

/// The tables of a diagram's blocks. A table of the file of constants, and then one of the
/// experiment, replaces keys of the block that it names.
/// @param constants  empty: none   @throws Error for a block that the diagram lacks   @setup
[[nodiscard]] std::vector<Config> blocks_of(const Config& diagram,
                                            const std::filesystem::path& constants,
                                            const Config& experiment);

/// A schedule from seconds.
[[nodiscard]] constexpr Schedule schedule_of(double period, double phase,
                                             MissedSteps missed = MissedSteps::Make) {
  return {from_seconds(period), from_seconds(phase), missed};
}

/// Reads `late_inputs` of a machine: "due" for a simulated one, "newest" for a real one.
/// @param due  what a simulated one does about missed steps
/// @returns what the machine does   @throws Error with the place of another value   @setup
[[nodiscard]] MissedSteps read_late_inputs(const Config& table, const char* otherwise,
                                           MissedSteps due);

}  // namespace rths::adapters
