// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// Keys: stiffness_N_per_m, handshake, prompt. @throws Error with the place of the first wrong
/// value   @setup
[[nodiscard]] experiment::NodeSettings read_echo(const std::string& node, const Config& table,
                                                 const experiment::Experiment& setup);

}  // namespace rths::adapters
