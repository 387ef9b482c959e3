// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/axis.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::adapters {

/// The virtual SRMD: a bearing test machine with the words of the real one.
struct SrmdSettings {
  sim::TestMachine machine;
  double period = 0.001;                    ///< [s]
  double compression_time_constant = 0.05;  ///< of the vertical load's first-order lag [s]
  double lift_pressure = 8.963e6;           ///< of the hydrostatic bearings [Pa]: 1,300 psi
  std::vector<std::string> axes = names_of(kHorizontal);  ///< moving axes; others stay at rest
  experiment::Retreat retreat;
};

/// @throws Error if a parameter is outside its physical range   @setup
[[nodiscard]] std::unique_ptr<Adapter> make_srmd(const SrmdSettings& settings);

}  // namespace rths::adapters
