// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <rths/adapters/opf_handshake.hpp>
#include <rths/experiment/node.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::adapters {

/// Keys: handshake, vertical_feedback. @throws Error with the place of the first wrong value @setup
[[nodiscard]] experiment::NodeSettings read_numerical(const std::string& node, const Config& table,
                                                      const experiment::Experiment& setup);
/// Builds the solver for a handshake.   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_numerical_node(
    const experiment::Experiment& setup, const experiment::NodeContext& context,
    Handshake handshake, sim::VerticalFeedback vertical = sim::VerticalFeedback::Model);

}  // namespace rths::adapters
