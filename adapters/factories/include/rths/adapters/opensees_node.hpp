// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// Keys: see docs/opensees.md. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_opensees_node(const std::string& node,
                                                          const Config& table,
                                                          const experiment::Experiment& setup);
/// Keys: see docs/opensees.md. @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_opensees_specimen_node(
    const std::string& node, const Config& table, const experiment::Experiment& setup);

}  // namespace rths::adapters
