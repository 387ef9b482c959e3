// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/core/axis.hpp>
#include <rths/experiment/node.hpp>
#include <rths/experiment/retreat.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/machine/platen_machine.hpp>
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

/// A virtual SRMD. Without keys, it has two axes. `model` names a machine file, with six degrees of
/// freedom; `family_member` (0: nominal) and a table `changes` vary it.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] experiment::NodeSettings read_srmd(const std::string& node, const Config& table,
                                                 const experiment::Experiment& setup);
/// An ideal machine; has no keys of its own. @throws Error with the place of the first wrong value
/// @setup
[[nodiscard]] experiment::NodeSettings read_ideal_machine(const std::string& node,
                                                          const Config& table,
                                                          const experiment::Experiment& setup);

}  // namespace rths::adapters
