// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/force_observer.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/specimen_model.hpp>
#include <rths/controller/table_force.hpp>
#include <rths/controller/target_force.hpp>
#include <rths/core/config.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::experiment {

/// The diagram that a node runs, and the values that replace those of its blocks.
struct DiagramChoice {
  std::filesystem::path diagram;
  std::filesystem::path constants;  ///< empty: none
  Config blocks;                    ///< of the experiment, with priority
};
/// Reads the keys diagram, constants and blocks of a node.
/// @throws Error with the place of a file that does not exist   @setup
[[nodiscard]] DiagramChoice read_diagram_choice(const Config& table);

/// The tables of a diagram's blocks. A table of the file of constants, and then one of the
/// experiment, replaces keys of the block that it names.
/// @param constants  empty: none   @throws Error for a block that the diagram lacks   @setup
[[nodiscard]] std::vector<Config> blocks_of(const Config& diagram,
                                            const std::filesystem::path& constants,
                                            const Config& experiment);

/// Index of an axis in a list of values in the order long, lat, vert, roll, pitch, yaw.
[[nodiscard]] std::size_t index_of_axis(const std::string& axis);

/// The values of the given axes in such a list; `otherwise` for all if the table lacks the key.
/// @throws Error with the key's place if the list is too short   @setup
[[nodiscard]] std::vector<double> per_axis(const Config& table, const std::string& key,
                                           const std::vector<std::string>& axes, double otherwise);

/// Whether a target comes in each tick. The predictor-corrector then has one substep, a whole tick.
/// @param simulation_step, tick  wall time of a step, and of a tick of the controller [s]
[[nodiscard]] bool is_one_tick(double simulation_step, double tick);

/// Of a block `predictor_corrector`, but for axes and steps, which are those of the run.
/// @throws Error with the place of a wrong value   @setup
[[nodiscard]] controller::PredictorCorrectorSettings predictor_corrector_settings(
    const Config& table);
/// Sampling delays of such a block, one per axis [substeps].
/// @param period  of a substep [s]   @throws Error with the key's place   @setup
[[nodiscard]] std::vector<int> sampling_delays(const Config& table,
                                               const std::vector<std::string>& axes, double period);

/// Of a block `adaptive_inverse`, one per axis.
/// @param period  of the block [s]   @throws Error with the place of a wrong value   @setup
[[nodiscard]] std::vector<controller::AdaptiveInverseSettings> adaptive_inverse_settings(
    const Config& table, const std::vector<std::string>& axes, double period);

/// Of a block `target_force`.
/// @param period    of the block [s]   @param interval  between two targets [s]
/// @param specimen  as the test assumes it; null, or sliders in the table: the force of sliders
/// @throws Error with the place of a wrong value   @setup
[[nodiscard]] controller::TargetForceSettings target_force_settings(
    const Config& table, const std::vector<std::string>& axes, double period, double interval,
    const sim::Bearing* specimen);

/// Of a block `force_observer`.
struct ForceObserverSettings {
  std::vector<controller::MachineForce> machine;  ///< one per axis
  int slope_samples = 32;
};
/// @throws Error with the place of a wrong value   @setup
[[nodiscard]] ForceObserverSettings force_observer_settings(const Config& table,
                                                            const std::vector<std::string>& axes);

/// Of a block `table_force_observer`.
struct TableForceObserverSettings {
  std::vector<controller::TableForce> machine;  ///< one per axis
  controller::TableObserverSettings observer;
};
/// @param period  of the block [s]   @throws Error with the place of a wrong value   @setup
[[nodiscard]] TableForceObserverSettings table_force_observer_settings(
    const Config& table, const std::vector<std::string>& axes, double period);

/// Makes the specimen that a test assumes, for a controller.
/// @param axes  each long or lat   @param period  of its moves [s]
/// @throws Error as sim::BearingRun does, when it makes one   @setup
[[nodiscard]] controller::MakeSpecimen assumed_specimen(const sim::Bearing& bearing,
                                                        const std::vector<std::string>& axes,
                                                        double period);

}  // namespace rths::experiment
