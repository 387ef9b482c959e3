// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// An ideal controller and machine: feedbacks equal the commands at once, forces are those of a
/// linear spring. Works with every laboratory's map. Use it to try out a solver's script and to
/// measure the round-trip time.
/// Keys: stiffness_N_per_m, handshake, prompt. @throws Error with the place of the first wrong
/// value   @setup
[[nodiscard]] experiment::NodeSettings read_echo(const std::string& node, const Config& table,
                                                 const experiment::Experiment& experiment);

}  // namespace rths::adapters
