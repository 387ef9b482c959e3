// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/config.hpp>
#include <rths/sim/ground_motion.hpp>
#include <rths/sim/isolated_plant.hpp>

namespace rths::adapters {

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

struct NumericalSettings {
  std::vector<std::string> axes = {"long", "lat"};
  sim::IsolatedPlant plant;
  sim::GroundMotion motion;
  double bearing_initial_stiffness = 0;  ///< one bearing [N/m]
  double integration_step = 0.01;        ///< Δt_int, model time [s]
  double alpha = -0.05;                  ///< of α-OS [-]
  double duration = 40;                  ///< model time [s]
  double rest = 0;                       ///< before the first step [s]
  double wait_deadline = 1;              ///< for each flag of the handshake [s]
  Handshake handshake = Handshake::AtTargetFirst;
  std::optional<ComputingTime> computing_time;  ///< empty: the actual time
  std::optional<DisplacementHistory> history;   ///< instead of the analysis
};

/// Reads a [plant] table. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] sim::IsolatedPlant read_plant(const Config& table);
/// Reads a [motion] table: .AT2 or columns, scaled. @setup
[[nodiscard]] sim::GroundMotion read_motion(const Config& table);

/// The project's own solver as a node with OpenFresco's words and handshake. It writes targets and
/// newTarget, waits for switchPC and atTarget, and reads the sampled feedback.
/// @throws Error if the model cannot be assembled   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_numerical(const NumericalSettings& settings);

}  // namespace rths::adapters
