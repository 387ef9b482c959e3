// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <rths/adapters/opf_layout.hpp>

namespace rths::adapters {

/// One signal of a control point: a word of OpenFresco's block with its limits and offsets.
struct ControlSignal {
  OpfSignal word;
  double lowest =
      -std::numeric_limits<double>::infinity();  ///< -lim, of the value on the ring [SI]
  double highest = std::numeric_limits<double>::infinity();  ///< [SI]
  bool is_relative_to_first = false;     ///< -relTrial: the first trial counts as 0
  bool is_relative_to_measured = false;  ///< -relCtrl: a command of 0 is the start position;
                                         ///< -relDaq: a feedback counts from its start value
};

struct ControlPoints {
  bool is_declared = false;           ///< by the user; else taken from the block
  std::vector<ControlSignal> trial;   ///< all commands of the block, in its order
  std::vector<ControlSignal> output;  ///< feedbacks
};

/// Reads the control points of a laboratory's OpenFresco script, one per line:
///
///     expControlPoint 1 1 disp 2 disp        # tag, then degree of freedom and type of each signal
///
/// A degree of freedom is a number, counted along the axes of the block, a letter and a number
/// (d1), or ux, uy, uz, rx, ry, rz. Types: disp, vel, accel, force, time, their numbers 1 to 5,
/// dsp, acc, frc, tme. Options: -lim low high (in the map's unit), -relTrial, -relCtrl, -relDaq;
/// -relOut has no effect, as in OpenFresco. -fact is refused, because OpenFresco's SCRAMNet
/// controls ignore it and the map already defines units.
///
/// OpenFresco writes control signals consecutively and expects the flags after the last one. One
/// missing signal shifts all words after it. The lines are therefore checked against the layout.
/// Without lines, the layout's own words are used.
/// @throws Error that names the control point with a missing, additional or different signal
/// @setup
[[nodiscard]] ControlPoints control_points(const OpfLayout& layout,
                                           const std::vector<std::string>& trial,
                                           const std::vector<std::string>& output);

}  // namespace rths::adapters
