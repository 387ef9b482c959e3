// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// Reads the table of a node that is a program of the user's own. The settings build no adapter.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_external(const std::string& node, const Config& table,
                                                     const experiment::Experiment& setup);

}  // namespace rths::adapters
