// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <span>

#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/sim/motion_file.hpp>

// Readers of the tables of an experiment, in the order in which they are called. Each uses the
// parts before it and throws Error with the place of the first wrong key or value.   @setup
namespace rths::experiment {

/// Files of ground motion, each read once.
class MotionFiles {
 public:
  /// @throws Error as `sim::read_motion_file`
  const sim::MotionFile& at(const std::filesystem::path& file);

 private:
  std::map<std::filesystem::path, sim::MotionFile> files_;
};

/// A [motion] table: a file of any format, scaled. Zeros follow the shorter channels of a station's
/// file. Keys without an effect are refused.
[[nodiscard]] sim::GroundMotion read_motion(const Config& table, MotionFiles& files);
/// [motion] and [held_out].
void read_earthquakes(const Config& file, Experiment& experiment);
/// [plant]
[[nodiscard]] Plant read_plant(const Config& file);
/// The bearing with the changes of [specimen], [machine], and the assumed model of both.
void read_laboratory(const Config& file, Experiment& experiment);
/// [targets]: displacements that are imposed in place of an analysis. Axes that are not tested stay
/// at rest.
/// @param seed  of noise
[[nodiscard]] DisplacementHistory read_targets(const Config& table, const Experiment& experiment,
                                               std::uint64_t seed);
/// [solver]
[[nodiscard]] Solver read_solver(const Config& table);
/// [node.…]
[[nodiscard]] std::vector<NodePlan> read_nodes(std::span<const AdapterKind> kinds,
                                               const Config& table, const Experiment& experiment);
/// [host.…] and [network], `fidelity`, [cards] and [[fault]]
void read_ring(const Config& file, Experiment& experiment);
/// [uncompensated]
void read_uncompensated(const Config& table, std::vector<NodePlan>& nodes);
/// [reference]
[[nodiscard]] DisplacementHistory read_reference(const Config& table);

/// The time of machine and controller stands still together, or of none: a machine that is real, of
/// another host or of another period moves on, and so do cards.
void settle_missed_steps(Experiment& experiment);

}  // namespace rths::experiment
