// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/controller/safety.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/config.hpp>
#include <rths/core/schedule.hpp>
#include <rths/experiment/parts.hpp>
#include <rths/memmap/map.hpp>

namespace rths::adapters {
class Adapter;
struct Port;
}  // namespace rths::adapters

namespace rths::experiment {

struct Experiment;
struct NodeSettings;

/// Task of a node in the test. Nodes start in this order: receivers before senders.
enum class Role {
  Recorder,
  Machine,
  Controller,
  Solver,  ///< its Done ends the test
};

/// What the table [machine] means to a node.
enum class MachineTable {
  Unused,
  Model,     ///< only the model in the diagnosis: the machine is the user's own
  Carriage,  ///< only what the platen carries, `empty_table` and `rollers`: its file has the rest
  Whole,
};

/// A node that is a program of the user's own.
struct UserProgram {
  std::vector<std::string> command;  ///< with placeholders; empty: the user starts it
  std::filesystem::path folder;      ///< in which it runs
  double connect_deadline = 60;      ///< until it is on the ring, and until it first writes [s]
  double longest_silence = 1;        ///< later, without a new value in its words; model time [s]
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

/// What the adapter of a solver states about it.
struct SolverTraits {
  bool integrates_plant = false;    ///< α-OS of the experiment's plant, which a budget repeats
  bool has_computing_time = false;  ///< modelled by keys of [solver]
  bool waits_for_flags = false;     ///< of the handshake, at most `wait_deadline_s` of [solver]
  int ticks_per_target = 1;         ///< of a controller that reads the flags once per tick
  bool may_not_end = false;         ///< the user's own: the launcher ends a late run
  std::string target_count;  ///< monitor that counts its targets; empty: their time counts them
  std::vector<std::string> floors;  ///< names of its monitors floor.1, …, of one with a structure
  std::string motion_fault;         ///< why it cannot run under another motion; empty: it can
  /// Of one with a structure of its own that can run again: the node that then takes the place of
  /// controller and machine, for the purely numerical result. Null: it cannot.
  std::shared_ptr<const NodeSettings> ideal_machine;
};

/// What the test needs to know of a node, from its adapter.
struct NodeSettings {
  Role role = Role::Machine;
  Schedule schedule;          ///< unless the table states another
  int priority = 30;          ///< of its real-time thread, 1…60
  bool keeps_times = false;   ///< the recording has start and duration of each step
  double start_deadline = 0;  ///< to become ready, beyond the time that every node has [s]
  bool lacks_safety = false;  ///< a machine whose commands pass no safety layer
  double longest_stop = 0;    ///< of its safety layer [s]; 0: that of the retreat
  /// Limits of its safety layer by axis, for programs that show them.
  std::vector<std::pair<std::string, controller::SafetyLimits>> safety_limits;
  MachineTable machine_table = MachineTable::Unused;
  SolverTraits solver;
  /// The node is this program of the user's own; then `make` may be empty.
  std::optional<UserProgram> program;
  /// Its files, for the recording: name, and content or SHA-256. May be empty. @throws Error
  std::function<std::vector<std::pair<std::string, std::string>>()> texts;
  /// Checks requirements of the host, such as programs; may be empty. @throws Error   @setup
  std::function<void()> check;
  /// Monitors of an adapter that is built after the others, when the map of the ring is complete.
  std::vector<adapters::Port> (*monitors)() = nullptr;
  /// @throws Error   @setup
  std::function<std::unique_ptr<adapters::Adapter>(const Experiment&, const NodeContext&)> make;
};

/// A kind of adapter, by its name in an experiment.
struct AdapterKind {
  const char* name;
  /// Reads the table of a node. The reader of the experiment reads host, period_s, phase_s and
  /// tune, and rejects unknown keys.
  /// @throws Error with the place of the first wrong value   @setup
  NodeSettings (*read)(const std::string& node, const Config& table, const Experiment& experiment);
};

/// A node of the map and the adapter that runs there.
struct NodePlan {
  std::string node;
  std::string host;     ///< empty: the test runs on one host
  std::string adapter;  ///< name of its kind
  Config table;         ///< its own of the experiment
  NodeSettings settings;
  Schedule schedule;
  Tuning tune;           ///< initial values of its parameters
  Tuning uncompensated;  ///< parameter values that switch compensation off

  /// The last value of a parameter counts.
  void switch_compensation_off() {
    tune.insert(tune.end(), uncompensated.begin(), uncompensated.end());
  }
};

/// Reads `late_inputs` of a machine: "due" for a simulated one, "newest" for a real one.
/// @param due  what a simulated one does about missed steps
/// @returns what the machine does   @throws Error with the place of another value   @setup
[[nodiscard]] MissedSteps read_late_inputs(const Config& table, const char* otherwise,
                                           MissedSteps due);

}  // namespace rths::experiment
