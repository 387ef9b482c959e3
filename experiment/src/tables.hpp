// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/experiment/improvement.hpp>
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
/// A bearing's file with changes, which may name the file as `model`.
[[nodiscard]] Config read_bearing_with(const Config& changes);
/// The same with the changes of [specimen].
[[nodiscard]] Config read_specimen(const Config& file);
/// The bearing with the changes of [specimen], [machine], and the assumed model of both.
/// @param improvement  text of an improved.toml, added to those that the model lists; may be empty
void read_laboratory(const Config& file, const std::string& improvement, Experiment& experiment);
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
/// Nodes, modes and bearings for the pictures of a report, as JSON.
[[nodiscard]] std::string structure_text(const sim::StructureSketch& sketch);
/// [host.…] and [network], `fidelity`, [cards] and [[fault]]
void read_ring(const Config& file, Experiment& experiment);
/// @throws Error if the handshake takes longer than a step
void check_handshake(const Config& file, const Experiment& experiment);
/// [uncompensated]
void read_uncompensated(const Config& table, std::vector<NodePlan>& nodes);
/// [reference]
[[nodiscard]] DisplacementHistory read_reference(const Config& table);

/// The time of machine and controller stands still together, or of none: a machine that is real, of
/// another host or of another period moves on, and so do cards.
void settle_missed_steps(Experiment& experiment);

/// [model]. Its tables `specimen` and `machine` hold the differences between model and laboratory;
/// `fitted` lists the fitted parameters.
/// @param found  overrides these tables
/// @param specimen  the bearing with the changes of [specimen]   @param machine  [machine]
/// @param axial_load  on the bearing [N]
[[nodiscard]] AssumedModel read_assumed_model(const Config& model, const Improvement& found,
                                              const Config& specimen, const Config& machine,
                                              double axial_load);

/// Refuses keys that no node of the experiment uses: the test would be the same without them.
/// Collects tables without an effect that other runs of the same file need as remarks.
void check_uses(const Config& file, Experiment& experiment);

/// Largest values of a component of a ground motion, without its drift.
struct MotionSizes {
  double acceleration = 0;  ///< [m/s²]
  double velocity = 0;      ///< [m/s]
  double displacement = 0;  ///< [m]
};
[[nodiscard]] MotionSizes sizes_of(const std::vector<double>& acceleration, double time_step);

/// Sizes of a motion that betray a wrong unit.
/// @param table  [motion] or [held_out], for the place and for `scale`   @param axes  tested ones
/// @returns what is unusual, but possible   @throws Error with the likely unit
[[nodiscard]] std::vector<std::string> check_motion(const Config& table,
                                                    const sim::GroundMotion& motion,
                                                    const std::vector<std::string>& axes);

/// Numbers that differ from those that they replace by the factor of a unit, such as kN as N.
/// @throws Error with the place and the likely unit of the first one
void check_units(const Config& changes, const Config& original);

}  // namespace rths::experiment
