// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/recording/recording.hpp>
#include <rths/sim/test_machine.hpp>

namespace rths::commissioning {

/// One signal of an axis against the signal that it should follow.
struct SignalFinding {
  std::string axis, role, signal;
  std::string against;     ///< what it should follow: a signal, or a computed quantity
  double gain = 0;         ///< slope of the signal against it, at the best lag [-]
  double correlation = 0;  ///< at that lag [-]
  double crossed = 0;      ///< correlation with the same quantity of the other axis [-]
  std::string trouble;     ///< empty: as expected

  [[nodiscard]] bool is_fine() const { return trouble.empty(); }
};

/// Checks sign, unit and axis of every signal that [roles] binds, from a recording in which the
/// axes move: each displacement follows the one before it in the path, the acceleration is the
/// second derivative of the displacement, and the forces are those of the assumed specimen and of
/// the inertia of the platen under the measured motion.
/// @param machine  as assumed   @param specimen  as assumed; null: the machine has none
/// @throws Error if the recording is empty, or no axis moves   @setup
[[nodiscard]] std::vector<SignalFinding> check_signals(const recording::Reader& run,
                                                       const sim::TestMachine& machine,
                                                       const sim::Bearing* specimen);

}  // namespace rths::commissioning
