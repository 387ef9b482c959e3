// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/commissioning/loop_stability.hpp>
#include <rths/commissioning/signal_check.hpp>
#include <rths/launch/run.hpp>
#include <rths/maths/delay.hpp>
#include <rths/report/judgement.hpp>

namespace rths::session {

using experiment::Experiment;

/// How a pretest decides.
struct PretestSettings {
  std::filesystem::path folder;      ///< for the recordings of its runs
  std::filesystem::path machine;     ///< recording of the machine; empty: of the virtual one
  double most_ringing = 0.15;        ///< amplitude up to which the loop may ring, of the peak [-]
  double least_delay_margin = 1e-3;  ///< at the peak [s]
  std::string version;               ///< of the program, for the recordings
  std::function<void(const std::string& step)> begins;  ///< called before each step; may be empty
};

/// Prediction for one axis.
struct AxisPrediction {
  std::string name;           ///< "long", "lat"
  sim::AxisTransfer machine;  ///< identified
  double machine_delay = 0;   ///< of its displacement behind its reference [s]
  double peak = 0;            ///< of the purely numerical response [m]
  std::vector<commissioning::AmplitudeMargin>
      margins;                      ///< by rising amplitude, up to the peak; empty: unknown
  double ringing = 0;               ///< largest amplitude at which the loop is unstable [m]
  std::vector<double> differences;  ///< of the responses, RMS over that of the test: of each
                                    ///< run with the noise of another seed [-]
  double delay = 0;                 ///< of the measured displacement behind the command [s]
  maths::TrackingError tracking;    ///< of it

  [[nodiscard]] double difference() const;  ///< the mean of the runs; 0 without a run [-]
};

struct Pretest {
  std::vector<commissioning::SignalFinding> signals;
  std::vector<AxisPrediction> axes;
  std::string loop_machine;  ///< that closed the loop; empty: no loop was closed
  std::vector<report::Broken>
      broken;                        ///< conditions of a conclusive test that the first run breaks
  std::vector<std::string> reasons;  ///< of a no-go; empty: go

  [[nodiscard]] bool is_go() const { return reasons.empty(); }
};

/// Runs the whole path in virtual time with a numerical specimen.
///
/// First the purely numerical result is computed, with the same model of the specimen, and its
/// motion is imposed without compensation: the signals are
/// checked, and the machine is identified. If all signals are right, the loop is closed with the
/// identified machine: stability margins, tracking, and the difference to the numerical result. It
/// scatters, so the loop is closed several times, each with other noise of the sensors. The
/// identified machine has two axes; a test that controls the vertical force keeps its own machine.
/// @throws Error if the experiment cannot be run this way   @setup
[[nodiscard]] Pretest pretest(const Experiment& experiment, const PretestSettings& settings);

[[nodiscard]] std::string text_of(const Pretest& pretest);
[[nodiscard]] std::string json_of(const Pretest& pretest);

}  // namespace rths::session
