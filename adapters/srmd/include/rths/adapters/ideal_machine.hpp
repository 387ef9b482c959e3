// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::adapters {

/// A specimen in a machine that is where it is told, at the end of every step: what a solver is
/// tried with, and what a real test is compared with. Answers OpenFresco's handshake by itself, in
/// the place of controller and machine.
struct IdealMachineSettings {
  sim::Bearing specimen;
  std::vector<std::string> axes = {"long", "lat"};
  double integration_step = 0.01;  ///< model time from target to target [s]
  double simulation_step = 0.01;   ///< from one arrival to the next, at least [s]
};

/// @throws Error as BearingRun does, or for an axis that is none   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_ideal_machine(const IdealMachineSettings& settings);

}  // namespace rths::adapters
