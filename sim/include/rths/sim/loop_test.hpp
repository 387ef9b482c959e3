// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/bearing.hpp>

namespace rths::sim {

/// A test that shows a bearing's loop: sines along both axes, the lateral one at twice the
/// frequency, so that the path is a figure of eight. The amplitude grows during the first cycle.
struct LoopTest {
  double amplitude_long = 0.2;      ///< [m]
  double amplitude_lat = 0;         ///< [m]
  double frequency = 0.3;           ///< [Hz]
  int cycles = 4;                   ///< including the growing first one
  double axial_load_variation = 0;  ///< amplitude over mean [-]
  double vertical_offset = 0;       ///< [m]
  double vertical_amplitude = 0;    ///< [m]
  double auxiliary = 0;             ///< constant control input of a device: a current [A]
  double time_step = 1e-3;          ///< rounded to a whole number of steps per cycle [s]
};

/// Time step for a smooth loop at any frequency [s]: 1 ms, changed where necessary to give 1,000 to
/// 20,000 steps per cycle.   @setup
[[nodiscard]] double time_step_of(double frequency);

/// Signals of a loop test, one sample per step.
struct LoopHistory {
  std::vector<double> time;                                 ///< [s]
  std::vector<double> command_long;                         ///< input of the first term [m]
  std::vector<double> displacement_long, displacement_lat;  ///< [m]
  std::vector<double> acceleration_long;                    ///< [m/s²]
  std::vector<double> force_long, force_lat;                ///< [N]
  std::vector<double> vertical_displacement;                ///< [m]
  std::vector<double> axial_load;                           ///< [N]
};

/// @throws Error as Composition does, if the test has no cycle or no step, or if it prescribes the
///         axial load of a bearing that computes it   @setup
[[nodiscard]] LoopHistory run_loop_test(const Bearing& bearing, const LoopTest& test);

/// Key figures of one full cycle along the long axis.
struct CycleNumbers {
  double peak_force = 0;           ///< largest [N]
  double strength = 0;             ///< mean |force| at zero displacement [N]
  double effective_stiffness = 0;  ///< between the displacement peaks [N/m]
  double energy = 0;               ///< dissipated, both axes [J]
};

/// One entry for each full cycle after the growing first one.   @setup
[[nodiscard]] std::vector<CycleNumbers> cycle_numbers(const LoopHistory& history,
                                                      const LoopTest& test);

/// The effect of one kind of term with typical parameters: the same test without and with the term.
struct Demonstration {
  LoopHistory without, with;
  bool alone = false;  ///< the term needs no other terms; `without` is an empty bearing
};

/// Demonstrates a kind on a plain lead-rubber bearing or its axial spring.   @setup
[[nodiscard]] Demonstration demonstrate(const TermKind& kind);

}  // namespace rths::sim
