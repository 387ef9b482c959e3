// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/adapters/echo.hpp>
#include <rths/adapters/numerical.hpp>
#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>
#include <rths/memmap/map.hpp>
#include <rths/recording/recording.hpp>
#include <rths/replicated/images.hpp>

namespace rths::launch {

/// Version of the experiment file format. Incremented when a valid file would change its meaning or
/// no longer load.
inline constexpr int kExperimentFormat = 1;

enum class ClockKind { Wall, Virtual };

/// Names and values of parameters of a node [SI].
using Tuning = std::vector<std::pair<std::string, double>>;

/// A host of a test that runs on several.
struct HostPlan {
  std::string name;
  std::string address;    ///< for the other hosts; empty: found by multicast
  std::string interface;  ///< name or address; empty: `address`, or else the network's default
};

/// A node of the map and the adapter that runs there.
struct NodePlan {
  std::string node;
  std::string host;     ///< empty: the test runs on one host
  std::string adapter;  ///< numerical, opensees, simulink_like, srmd, ideal_machine, echo,
                        ///< opensees_specimen or recorder
  adapters::Schedule schedule;
  std::filesystem::path diagram;                                        ///< of a simulink_like
  adapters::Handshake handshake = adapters::Handshake::AtTargetFirst;   ///< of a numerical
  std::optional<adapters::OpenSeesSettings> opensees;                   ///< of an opensees
  std::optional<adapters::EchoSettings> echo;                           ///< of an echo
  std::optional<adapters::OpenSeesSpecimenSettings> opensees_specimen;  ///< of an opensees_specimen
  Tuning tune;           ///< initial values of its parameters
  Tuning uncompensated;  ///< parameter values that switch compensation off
};

/// Content of an experiment file, checked.
struct Experiment {
  std::filesystem::path file;
  std::string name;
  std::filesystem::path map;
  std::vector<std::string> axes;
  double integration_step = 0.01;  ///< Δt_int: model time per target [s]
  double rate = 1;                 ///< Δt_sim/Δt_int: 1 is real time
  double duration = 0;             ///< model time [s]
  double rest = 0;                 ///< time at rest before the loop closes [s]
  std::uint64_t seed = 1;
  std::string motion_name;
  sim::GroundMotion motion;
  std::optional<sim::GroundMotion>
      held_out;  ///< a second earthquake, for the proof of the diagnosis
  sim::IsolatedPlant plant;
  sim::Bearing specimen;  ///< the bearing on the platen
  sim::Bearing model;     ///< the bearing as the simulation assumes it
  sim::TestMachine machine;
  sim::TestMachine assumed_machine;  ///< the machine as the simulation assumes it
  double alpha = -0.05;              ///< of α-OS
  double wait_deadline = 1;          ///< [s]
  adapters::ComputingTime computing_time;
  bool model_computing_time = false;  ///< also in wall time, where this solver is fast
  adapters::Retreat retreat;
  std::optional<replicated::CardOptions> cards;  ///< of fidelity "replicated"; empty: "shared"
  std::vector<HostPlan> hosts;                   ///< by name; empty: one host
  std::uint32_t domain = 0;                      ///< of DDS, between the hosts
  double host_deadline = 60;                     ///< wait for the other hosts [s]
  std::vector<NodePlan> nodes;                   ///< in starting order
  std::optional<adapters::DisplacementHistory> history;  ///< imposed instead of an analysis
  Config conclusive;             ///< bounds of a conclusive test; report::read_bounds checks them
  recording::NamedTexts config;  ///< input files, for the recording

  [[nodiscard]] double simulation_step() const { return rate * integration_step; }  ///< [s]
  /// The host that starts the test and has the recording; empty if there is one host.
  [[nodiscard]] std::string leading_host() const;
};

/// Changes of the command line to an experiment file: dotted key, value as TOML.
using Overrides = std::vector<std::pair<std::string, std::string>>;

/// @throws Error file:line:column of the first fault   @setup
[[nodiscard]] Experiment load_experiment(const std::filesystem::path& file,
                                         const Overrides& overrides = {});

}  // namespace rths::launch
