// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/structure_model.hpp>
#include <rths/sim/test_machine.hpp>

// The parts of an experiment, as its tables state them.
namespace rths::experiment {

/// Steps and length of a test.
struct TimePlan {
  double integration_step = 0.01;  ///< Δt_int: model time per target [s]
  double rate = 1;                 ///< Δt_sim/Δt_int: 1 is real time
  double duration = 0;             ///< model time [s]
  double rest = 0;                 ///< time at rest before the loop closes [s]

  [[nodiscard]] double simulation_step() const { return rate * integration_step; }  ///< [s]
};

/// [motion]
struct Earthquake {
  std::string name;
  sim::GroundMotion motion;
};

/// [plant]
struct Plant {
  std::shared_ptr<const sim::StructureModel> structure;
  bool is_stated = false;  ///< in the file
};

/// [machine]
struct Machine {
  sim::TestMachine simulated;
  bool is_identified = false;  ///< `simulated` replaces a model that the machine's node names
};

/// [model]: specimen and machine as the simulation assumes them.
struct AssumedModel {
  sim::Bearing bearing;      ///< in place of the specimen
  sim::TestMachine machine;  ///< in place of the machine
  std::string text;          ///< [model] of a case as TOML: bearing, machine, fitted parameters
  std::string specimen;      ///< the bearing as TOML; empty without a specimen
};

/// A seeded model of the solver's computing time per step in virtual time.
struct ComputingTime {
  double mean = 0.003;          ///< [s]
  double spread = 0.1;          ///< standard deviation over mean [-]
  double overrun_fraction = 0;  ///< fraction of the steps that take longer [-]
  double overrun = 0.006;       ///< additional time of such a step [s]
  std::uint64_t seed = 1;
};

/// Seeded computing times of a solver, one per step.
class ComputingTimes {
 public:
  explicit ComputingTimes(const ComputingTime& model) : model_{model}, random_{model.seed} {}
  /// Computing time of the next step [s].   @realtime
  [[nodiscard]] double draw() RTHS_REALTIME;

 private:
  ComputingTime model_;
  std::mt19937_64 random_;
};

/// [solver]
struct Solver {
  double alpha = -0.05;      ///< of α-OS
  int substeps = 1;          ///< of its integration between targets
  double wait_deadline = 1;  ///< for each flag of the handshake [s], times `rate`
  ComputingTime computing_time;
  bool models_computing_time = false;  ///< also in wall time, where this solver is fast
};

/// A displacement history to impose instead of an analysis.
struct DisplacementHistory {
  double time_step = 0;                   ///< [s]
  std::vector<double> displacement_long;  ///< [m]
  std::vector<double> displacement_lat;   ///< [m], as long as the other
};

/// Time step of purely numerical results [s].
inline constexpr double kReferenceStep = 0.001;

/// [stop]
struct StopPlan {
  Retreat retreat;
  double longest = 0;  ///< bound of the time from a stop until all nodes are at rest [s]
};

/// A host of a test that runs on several.
struct HostPlan {
  std::string name;
  std::string address;    ///< for the other hosts; empty: found by multicast
  std::string interface;  ///< name or address; empty: `address`, or else the network's default
};

/// [host.…] and [network]
struct Network {
  std::vector<HostPlan> hosts;  ///< by name; empty: one host
  std::uint32_t domain = 0;     ///< of DDS, between the hosts
  double deadline = 60;         ///< wait for the other hosts [s]
};

/// The cards of a ring of fidelity "replicated"; replicated::read_cards reads their tables.
struct CardTables {
  Config cards;                ///< [cards]
  std::vector<Config> faults;  ///< [[fault]]
};

/// Names and values of parameters of a node [SI].
using Tuning = std::vector<std::pair<std::string, double>>;

}  // namespace rths::experiment
