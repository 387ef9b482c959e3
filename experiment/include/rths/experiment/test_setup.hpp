// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/isolated_plant.hpp>
#include <rths/sim/motion_file.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::experiment {

/// A seeded model of the solver's computing time per step in virtual time.
struct ComputingTime {
  double mean = 0.003;          ///< [s]
  double spread = 0.1;          ///< standard deviation over mean [-]
  double overrun_fraction = 0;  ///< fraction of the steps that take longer [-]
  double overrun = 0.006;       ///< additional time of such a step [s]
  std::uint64_t seed = 1;
};

/// A displacement history to impose instead of an analysis.
struct DisplacementHistory {
  double time_step = 0;                   ///< [s]
  std::vector<double> displacement_long;  ///< [m]
  std::vector<double> displacement_lat;   ///< [m], as long as the other
};

/// Words of an axis of the machine, by their role.
struct MachineAxis {
  std::string name;                 ///< "long", "lat"
  std::string reference;            ///< to the machine [m]
  std::string displacement, force;  ///< its measurements [m], [N]
};

/// Properties of a hybrid test that its adapters share.
struct TestSetup {
  std::vector<std::string> axes;
  std::vector<MachineAxis> machine_axes;  ///< of the tested ones: long, lat
  double integration_step = 0.01;         ///< Δt_int: model time per target [s]
  double rate = 1;                        ///< Δt_sim/Δt_int: 1 is real time
  double duration = 0;                    ///< model time [s]
  double rest = 0;                        ///< time at rest before the loop closes [s]
  sim::GroundMotion motion;
  sim::IsolatedPlant plant;
  sim::Bearing specimen;  ///< the bearing on the platen
  sim::Bearing model;     ///< the bearing as the simulation assumes it
  sim::TestMachine machine;
  bool has_identified_machine =
      false;                 ///< `machine` replaces a model that the machine's node names
  double alpha = -0.05;      ///< of α-OS
  int substeps = 1;          ///< of its integration between targets
  double wait_deadline = 1;  ///< of a solver, for each flag of the handshake [s], times `rate`
  ComputingTime computing_time;
  bool model_computing_time = false;  ///< also in wall time, where this solver is fast
  Retreat retreat;
  double longest_stop = 0;  ///< bound of the time from a stop until all nodes are at rest [s]
  std::optional<DisplacementHistory> history;  ///< imposed instead of an analysis

  [[nodiscard]] double simulation_step() const { return rate * integration_step; }  ///< [s]
};

/// Reads a [plant] table. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] sim::IsolatedPlant read_plant(const Config& table);
/// Files of ground motion, each read once.
class MotionFiles {
 public:
  /// @throws Error as `sim::read_motion_file`
  const sim::MotionFile& at(const std::filesystem::path& file);

 private:
  std::map<std::filesystem::path, sim::MotionFile> files_;
};

/// Reads a [motion] table: a file of any format, scaled. Zeros follow the shorter channels of a
/// station's file.
/// @throws Error with the place of the first wrong value or key without an effect   @setup
[[nodiscard]] sim::GroundMotion read_motion(const Config& table, MotionFiles& files);
/// The same, with files that are not needed again.
[[nodiscard]] sim::GroundMotion read_motion(const Config& table);

/// Time step of purely numerical results [s].
inline constexpr double kReferenceStep = 0.001;
/// The motion that a test is expected to have: that of the purely numerical result.   @setup
[[nodiscard]] DisplacementHistory expected_motion(const TestSetup& setup);
/// Displacements of a table with a file: columns [m], scaled; the first row is the start.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] DisplacementHistory read_displacements(const Config& table);
/// Reads a [targets] table: displacements that are imposed in place of an analysis. Axes that are
/// not tested stay at rest.
/// @param seed  of noise   @throws Error with the place of the first wrong value   @setup
[[nodiscard]] DisplacementHistory read_targets(const Config& table, const TestSetup& setup,
                                               std::uint64_t seed);

/// Reads the [machine] table of an experiment: changed parameters of the SRMD, and terms.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] sim::TestMachine read_machine(const Config& table);

/// A key of a [machine] table, and what it sets in both axes.
struct MachineKey {
  const char* key;
  double sim::ServoAxis::*member;
};
[[nodiscard]] std::span<const MachineKey> machine_keys();

}  // namespace rths::experiment
