// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/sim/bearing.hpp>

namespace rths::sim {

/// A test that shows a bearing's loop: sines along both axes, the lateral one at twice the
/// frequency, so that the two together draw a figure of eight. The first cycle grows from rest.
struct LoopTest {
  double amplitude_long = 0.2;      ///< [m]
  double amplitude_lat = 0;         ///< [m]
  double frequency = 0.3;           ///< [Hz]
  int cycles = 4;                   ///< the first of which grows
  double axial_load_variation = 0;  ///< amplitude over mean [-]
  double vertical_offset = 0;       ///< [m]
  double vertical_amplitude = 0;    ///< [m]
  double auxiliary = 0;             ///< what controls a device, constant: a current [A]
  double time_step = 1e-3;          ///< rounded to a whole number of steps per cycle [s]
};

/// A step that draws a loop well at any frequency: 1 ms where that makes 1,000 to 20,000 steps per
/// cycle, else so that it does [s].   @setup
[[nodiscard]] double time_step_of(double frequency);

/// What happened, step by step.
struct LoopHistory {
  std::vector<double> time;                                 ///< [s]
  std::vector<double> command_long;                         ///< what the first term was given [m]
  std::vector<double> displacement_long, displacement_lat;  ///< [m]
  std::vector<double> acceleration_long;                    ///< [m/s²]
  std::vector<double> force_long, force_lat;                ///< [N]
  std::vector<double> vertical_displacement;                ///< [m]
  std::vector<double> axial_load;                           ///< [N]
};

/// @throws Error as Composition does, if the test has no cycle or no step, or if it gives the axial
///         load to a bearing that computes it   @setup
[[nodiscard]] LoopHistory run_loop_test(const Bearing& bearing, const LoopTest& test);

/// One full cycle of a loop along the long axis.
struct CycleNumbers {
  double peak_force = 0;           ///< largest [N]
  double strength = 0;             ///< mean of the force's size where it passes the middle [N]
  double effective_stiffness = 0;  ///< between the largest displacements [N/m]
  double energy = 0;               ///< dissipated, both axes [J]
};

/// Each full cycle after the first, which grows.   @setup
[[nodiscard]] std::vector<CycleNumbers> cycle_numbers(const LoopHistory& history,
                                                      const LoopTest& test);

/// The effect of one kind of term with typical parameters: the same test without and with it.
struct Demonstration {
  LoopHistory without, with;
  bool alone = false;  ///< the term needs no company: without it there is nothing
};

/// A plain lead-rubber bearing, or the axial spring below one, shows what the kind does to it.
/// @setup
[[nodiscard]] Demonstration demonstrate(const TermKind& kind);

}  // namespace rths::sim
