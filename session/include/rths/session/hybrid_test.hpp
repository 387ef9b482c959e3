// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/budget/budget.hpp>
#include <rths/core/config.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/recording.hpp>

namespace rths::session {

using experiment::Experiment;

/// The correction of the measured force by the controller's block diagram.
/// @throws Error if the controller runs no block diagram   @setup
[[nodiscard]] loop::ForceCorrection correction_of(const Experiment& experiment);

/// A run as the closed loop of a budget. Simulated parts come from [model] of the experiment. What
/// the run did itself comes from its recording: times of computing, lateness of the host,
/// compensation, vertical load, and the settings of its controller. The identified parts equal the
/// simulated ones.
/// @param run  recording with a controller that runs a block diagram, and a machine: those of the
///             experiment's roles
/// @throws Error if the recording lacks a signal   @setup
[[nodiscard]] budget::HybridTest hybrid_test_of(const Experiment& experiment,
                                                const recording::Reader& run);

/// Displacement of a run: the targets of its integrator, as `budget::closed_loop` returns them.
/// @throws Error if the recording lacks a signal   @setup
[[nodiscard]] budget::Response response_of(const Experiment& experiment,
                                           const recording::Reader& run);

/// Force that the integrator of a run received, by integration step: long, lat [N].   @setup
[[nodiscard]] std::array<std::vector<double>, 2> fed_force_of(const Experiment& experiment,
                                                              const recording::Reader& run);

/// Signals of one axis of the machine of a run.
/// @param axis  "long" or "lat"
/// @param order  of the ticks of the run   @throws Error if the recording lacks a signal   @setup
[[nodiscard]] sim::TransferRecord transfer_record_of(const recording::Roles& roles,
                                                     const recording::Reader& run,
                                                     const std::string& axis,
                                                     const loop::TickOrder& order);

/// The mismatch budget of a run. Its transfer system is identified from the recording.
/// @param improved  the experiment with the improvements of a diagnosis: its model holds specimen
///                  and machine as identified
/// @param held_out  recording of the same laboratory under another earthquake; null: none
/// @throws Error if a recording lacks a signal or, from the first target on, rows of more than
///         five integration steps, if the run has no controller or another solver than `numerical`,
///         if its targets carry rates, or as budget::mismatch_budget does   @setup
[[nodiscard]] budget::MismatchBudget budget_of_run(const Experiment& experiment,
                                                   const Experiment& improved,
                                                   const recording::Reader& run,
                                                   const recording::Reader* held_out);

/// The improved simulation as an experiment: its laboratory is the model of the given experiment
/// with the improvements and the identified transfer systems. Its simulation omits nothing.
/// @param experiment  with the changes of its command line
/// @param improvement  improved.toml of a diagnosis, as text; may be empty
/// @throws Error if a term is wrong   @setup
[[nodiscard]] Config improved_experiment(const Config& experiment, const std::string& improvement,
                                         const budget::MismatchBudget& found);

}  // namespace rths::session
