// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <rths/adapters/opf_layout.hpp>

namespace rths::adapters {

/// One signal of a control point: a word of OpenFresco's block, and what is done to its value.
struct ControlSignal {
  OpfSignal word;
  double lowest = -std::numeric_limits<double>::infinity();  ///< -lim, of what is sent [SI]
  double highest = std::numeric_limits<double>::infinity();  ///< [SI]
  bool is_relative_to_first = false;     ///< -relTrial: the first trial counts as 0
  bool is_relative_to_measured = false;  ///< -relCtrl: 0 is where the specimen stands at the start
                                         ///< -relDaq, of a feedback: what is measured then is 0
};

struct ControlPoints {
  bool is_declared = false;           ///< by the user, or just what the block has
  std::vector<ControlSignal> trial;   ///< commands, all that the block has, in its order
  std::vector<ControlSignal> output;  ///< feedbacks
};

/// What a laboratory's OpenFresco script declares, one line a control point:
///
///     expControlPoint 1 1 disp 2 disp        # tag, then degree of freedom and type of each signal
///
/// A degree of freedom is a number, counted along the axes of the block, a number behind a letter
/// (d1), or ux, uy, uz, rx, ry, rz. Types: disp, vel, accel, force, time, their numbers 1 to 5,
/// dsp, acc, frc, tme. Options: -lim low high, in the map's unit, -relTrial, -relCtrl, -relDaq;
/// -relOut does nothing, as in OpenFresco. -fact is refused: OpenFresco's SCRAMNet controls ignore
/// it, and who copies it means that.
///
/// OpenFresco writes control signals one behind the other and looks for the flags behind the last:
/// one signal too few, and every word behind it is another one. So the lines are held against
/// the layout. No lines stand for the layout's own words.
/// @throws Error that names the control point which declares too few, too many or another signal
/// @setup
[[nodiscard]] ControlPoints control_points(const OpfLayout& layout,
                                           const std::vector<std::string>& trial,
                                           const std::vector<std::string>& output);

}  // namespace rths::adapters
