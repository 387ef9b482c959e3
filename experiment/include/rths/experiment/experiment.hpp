// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/experiment/node.hpp>
#include <rths/experiment/parts.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

namespace rths::experiment {

/// Version of the experiment file format. Incremented when a valid file would change its meaning or
/// no longer load.
inline constexpr int kExperimentFormat = 1;

/// Content of an experiment file, checked.
struct Experiment {
  std::filesystem::path file;
  std::string name;
  std::string companion;  ///< how it differs from the test that it accompanies; empty: it does not
  std::filesystem::path map;
  std::vector<std::string> axes;  ///< the tested ones: long, lat
  std::uint64_t seed = 1;
  TimePlan time;
  Earthquake earthquake;
  std::optional<sim::GroundMotion> held_out;  ///< a second one, for the proof of the diagnosis
  Plant plant;
  sim::Bearing specimen;  ///< the bearing on the platen
  Machine machine;
  AssumedModel model;
  Solver solver;
  std::optional<DisplacementHistory> history;  ///< [targets]: imposed instead of an analysis
  StopPlan stop;
  std::vector<NodePlan> nodes;  ///< in starting order
  Network network;
  std::optional<CardTables> cards;  ///< of fidelity "replicated"; empty: "shared"
  /// Response that takes the place of the purely numerical one: [reference]
  std::optional<DisplacementHistory> reference;
  Config conclusive;       ///< bounds of a conclusive test; report::read_bounds checks them
  recording::Roles roles;  ///< nodes and signals by role
  Config role_table;       ///< their table; assemble() checks it against the map
  std::vector<std::string> remarks;  ///< about keys without an effect on this run
  recording::NamedTexts config;      ///< input files, without those of its nodes

  /// The node of a name; null: there is none.
  [[nodiscard]] const NodePlan* node(const std::string& called) const;
  /// True if a solver of this project ends the run.
  [[nodiscard]] bool has_own_solver() const;
  /// The ground motion along the tested axes.
  [[nodiscard]] sim::GroundMotion tested_motion() const;
  /// The latest regular end of a run since its start [s]; none if its solver surely ends it. A
  /// solver of the user's own may take twice as long as planned.
  [[nodiscard]] std::optional<double> latest_end() const;
  /// True if a node is a program of the user's own.
  [[nodiscard]] bool has_user_program() const;
  /// True if the solver integrates the experiment's plant.
  [[nodiscard]] bool integrates_plant() const;
  /// True if the experiment's plant is the structure of the solver: it integrates it, or is a
  /// program or adapter of the user's own whose structure [plant] states.
  [[nodiscard]] bool solves_plant() const;
  /// The solver, if it has a structure of its own and can run again with an ideal machine.
  [[nodiscard]] const NodePlan* repeatable_solver() const;
  /// The host that starts the test and has the recording; empty if there is one host.
  [[nodiscard]] std::string leading_host() const;
  /// The machine's node, if its commands pass no safety layer.
  [[nodiscard]] std::optional<std::string> unguarded_machine() const;
  /// All input files, for the recording. @throws Error if one cannot be read   @setup
  [[nodiscard]] recording::NamedTexts texts() const;
};

/// Changes of the command line to an experiment file: dotted key, value as TOML.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// An experiment file with changes. Its relative paths start at the file, or at its key `folder`.
/// @throws Error if the file cannot be read, or a change is invalid   @setup
[[nodiscard]] Config changed_experiment(const std::filesystem::path& file,
                                        const Overrides& overrides);

/// @param kinds  the adapters that a node can have
/// @param improvement  text of an improved.toml, added to those that the model lists; may be empty
/// @throws Error file:line:column of the first fault   @setup
[[nodiscard]] Experiment load_experiment(std::span<const AdapterKind> kinds,
                                         const std::filesystem::path& file,
                                         const Overrides& overrides = {},
                                         const std::string& improvement = "");

}  // namespace rths::experiment
