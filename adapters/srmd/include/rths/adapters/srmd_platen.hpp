// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/axis.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/machine/platen_machine.hpp>

namespace rths::adapters {

/// The virtual SRMD with six degrees of freedom, with all words of the real one. User input 1 is
/// the velocity feed-forward at the valves of the horizontal actuators: 10 V is a gain of 1.
struct SrmdPlatenSettings {
  sim::machine::PlatenMachine machine;
  double period = 0.001;                                  ///< [s]
  std::vector<std::string> axes = names_of(kHorizontal);  ///< driven by their references
  experiment::Retreat retreat;
};

/// @throws Error if a parameter is outside its range, or for an unknown axis   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_srmd_platen(const SrmdPlatenSettings& settings);

}  // namespace rths::adapters
