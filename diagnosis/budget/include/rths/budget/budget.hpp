// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include <rths/budget/closed_loop.hpp>
#include <rths/core/axis.hpp>
#include <rths/sim/axis_transfer.hpp>

namespace rths::budget {

/// The mismatch of one axis: difference between the response of the test and of its simulation.
struct AxisBudget {
  Axis axis = Axis::Long;
  sim::AxisTransfer transfer;     ///< as identified
  std::vector<double> measured;   ///< targets of the test, by integration step [m]
  std::vector<double> simulated;  ///< every part as simulated [m]
  std::vector<double> improved;   ///< every part as identified [m]
  /// RMS of measured displacement less command, over that of the command [-].
  double tracking = 0;
  /// Error of the transfer system on a record that it was not fitted to; NaN: there is none [-].
  double held_out = std::numeric_limits<double>::quiet_NaN();
  /// Error of a displacement equal to the reference on that record; NaN: there is none [-].
  double held_out_without = std::numeric_limits<double>::quiet_NaN();
  double noise = 0;  ///< RMS of the noise of the displacement, over that of the displacement [-]
  double before = 0, after = 0;        ///< RMS differences to the test over the RMS of the test [-]
  std::array<double, kParts> share{};  ///< of the energy of the difference before, by Part [-]
  double remainder = 0;                ///< of that energy; shares and remainder add up to 1 [-]
};

/// Which part of a hybrid test causes which share of the difference between its response and that
/// of its simulation. The share of a part is the mean over all orders in which parts can be
/// switched to "as identified".
struct MismatchBudget {
  double integration_step = 0;  ///< of the responses [s]
  std::vector<double> times;    ///< of the responses in the recording [s]; empty: not known
  std::vector<AxisBudget> axes;
  /// RMS difference of the analysis under the recorded force, over the RMS of the test [-].
  double replay = 0;
  int loops = 0;  ///< closed loops that were simulated
  /// What the shares of an axis, from 2 loops for each part and 2 more, fell short of their sum
  /// before they were made to add up [-]. 0: the shares come from all sets of parts.
  double share_error = 0;

  [[nodiscard]] bool is_empty() const { return axes.empty(); }
};

/// "tracking", "force", "specimen", "machine", "numerical", "host"
[[nodiscard]] const char* name_of(Part part);

/// Identifies the transfer systems and the noise of the sensors, then runs the closed loop with
/// sets of identified parts: none, each alone, all but each, all; 14, or 12 if the host was never
/// late. They tell the shares unless three parts interact. If they miss their sum by more than 1 %,
/// all 64 sets run, or 32.
/// @param measured  response of the test
/// @param records  of the machine; those of untested axes are ignored. The hydraulics of
///                 `test.machine_identified` become the identified ones.
/// @param force  fed to the integrator of the test, by integration step [N]
/// @throws Error if a closed loop diverges, or as `closed_loop` and `identify_transfer` do   @setup
[[nodiscard]] MismatchBudget mismatch_budget(HybridTest test, const Response& measured,
                                             const std::array<sim::TransferRecord, 2>& records,
                                             const std::array<std::vector<double>, 2>& force);

/// Whether the identified transfer system describes the motion: its error on unseen motion is at
/// most a tenth of the error of a displacement equal to the reference.
[[nodiscard]] bool is_tracking_identified(const MismatchBudget& budget);

/// The budget in one or two sentences: differences, shares, transfer system.
[[nodiscard]] std::string sentence_of(const MismatchBudget& budget);

}  // namespace rths::budget
