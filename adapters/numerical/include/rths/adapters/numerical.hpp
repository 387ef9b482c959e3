// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/core/axis.hpp>
#include <rths/experiment/node.hpp>
#include <rths/experiment/parts.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::adapters {

struct NumericalSettings {
  std::vector<std::string> axes = names_of(kHorizontal);
  std::shared_ptr<const sim::StructureModel> structure;
  sim::GroundMotion motion;
  double bearing_initial_stiffness = 0;  ///< one bearing [N/m]
  double integration_step = 0.01;        ///< Δt_int, model time [s]
  double alpha = -0.05;                  ///< of α-OS [-]
  int substeps = 1;                      ///< of the integration between targets
  double duration = 40;                  ///< model time [s]
  double rest = 0;                       ///< before the first step [s]
  double wait_deadline = 1;              ///< for each flag of the handshake [s]
  Handshake handshake = Handshake::AtTargetFirst;
  sim::VerticalFeedback vertical_feedback = sim::VerticalFeedback::Model;
  std::optional<experiment::ComputingTime> computing_time;  ///< empty: the actual time
  std::optional<experiment::DisplacementHistory> history;   ///< instead of the analysis
};

/// The project's own solver as a node with OpenFresco's words and handshake. It writes targets and
/// newTarget, waits for switchPC and atTarget, and reads the sampled feedback.
/// @throws Error if the model cannot be assembled   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_numerical(const NumericalSettings& settings);

/// Keys: handshake, vertical_feedback. @throws Error with the place of the first wrong value @setup
[[nodiscard]] experiment::NodeSettings read_numerical(const std::string& node, const Config& table,
                                                      const experiment::Experiment& experiment);
/// Builds the solver for a handshake.   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_numerical_node(
    const experiment::Experiment& experiment, const experiment::NodeContext& context,
    Handshake handshake, sim::VerticalFeedback vertical = sim::VerticalFeedback::Model);

}  // namespace rths::adapters
