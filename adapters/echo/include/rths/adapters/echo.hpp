// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/opf_layout.hpp>
#include <rths/experiment/node.hpp>

namespace rths::adapters {

/// An ideal controller and machine: feedbacks equal the commands at once, forces are those of a
/// linear spring. Works with every laboratory's map. Use it to try out a solver's script and to
/// measure the round-trip time.
struct EchoSettings {
  OpfLayout layout;
  double stiffness = 1e6;  ///< of each axis [N/m, N·m/rad]
  /// atTarget stays 0 until the first target arrives, as with older controllers.
  bool is_down_when_idle = false;
  bool is_prompt = false;  ///< also steps on each write of the solver, not only on schedule
};

[[nodiscard]] std::unique_ptr<Adapter> make_echo(const EchoSettings& settings);

/// Keys: stiffness_N_per_m, handshake, prompt. @throws Error with the place of the first wrong
/// value   @setup
[[nodiscard]] experiment::NodeSettings read_echo(const std::string& node, const Config& table,
                                                 const experiment::Experiment& experiment);

}  // namespace rths::adapters
