// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/axis.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::adapters {

/// A specimen in a machine that reaches its target at the end of every step. It replaces controller
/// and machine, and answers OpenFresco's handshake. Use it to try out a solver and as the reference
/// for a real test.
struct IdealMachineSettings {
  sim::Bearing specimen;
  std::vector<std::string> axes = names_of(kHorizontal);
  double integration_step = 0.01;  ///< model time between targets [s]
  double simulation_step = 0.01;   ///< shortest time between arrivals [s]
};

/// @throws Error as BearingRun does, or for an unknown axis   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_ideal_machine(const IdealMachineSettings& settings);

}  // namespace rths::adapters
