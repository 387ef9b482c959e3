// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/recording/recording.hpp>

namespace rths::report {

/// Bounds of a conclusive test: the table [conclusive] of an experiment. Fractions of displacement
/// and force refer to the largest command and the largest force of the axis.
struct Bounds {
  double at_limits = 0;             ///< time of a machine or controller at its limits [s]
  double nrms = 0.05;               ///< tracking error of the test, RMS [-]
  double window_nrms = 0.15;        ///< tracking error of any two seconds, RMS [-]
  double delay = 0.02;              ///< of the measured displacement, in model time [s]
  double resolution = 0.001;        ///< smaller errors of displacement are not judged [m]
  double offset = 0.03;             ///< of a measured displacement [-]
  double motion = 0.1;              ///< difference of displacement and acceleration, RMS [-]
  double response = 0.1;            ///< difference from the numerical result, RMS [-]
  double force_factor = 1.6;        ///< between measured and modelled force, either way [-]
  double force_delay = 0.03;        ///< of the measured force, in model time [s]
  double force_offset = 0.25;       ///< of a measured force [-]
  double displacement_jump = 0.02;  ///< of a sample from its neighbours [-]
  double force_jump = 0.08;         ///< the same of force, and of acceleration [-]
  double noise = 0.02;              ///< of a measured displacement or force, standard deviation [-]
  double repeated = 0.1;  ///< fraction of a second's samples that repeat the one before [-]
  double load = 0.25;     ///< difference of the vertical load from its reference, RMS [-]
  double missing = 0.01;  ///< fraction of the steps without a row [-]
  double late = 0.01;     ///< fraction of the integration steps in which the host was late [-]
};

/// Reads [conclusive]. @throws Error with the place of the first wrong key or value   @setup
[[nodiscard]] Bounds read_bounds(const Config& table);

/// A broken condition of a conclusive test.
struct Broken {
  std::string condition;        ///< "tracking", "force", …: docs/experiments.md lists them
  double time = 0;              ///< first time, since the run began [s]
  std::string signal;           ///< full name, or the node
  std::string found, expected;  ///< with units
  [[nodiscard]] std::string text() const;  ///< one line
};

/// Judges a run from its recording alone: from the recorded words, the experiment and the assumed
/// model of the specimen.
/// @param numerical  the purely numerical result, for the condition `response`; null: not judged
/// @returns the broken conditions by time; none: the test is conclusive
/// @throws Error if the recording holds no experiment   @setup
[[nodiscard]] std::vector<Broken> judge(const recording::Reader& run,
                                        const recording::Reader* numerical = nullptr);

/// RMS difference of the response of a run and the purely numerical result, over the RMS of the
/// response, by tested axis [-]. Empty if the recording holds no experiment.   @setup
[[nodiscard]] std::map<std::string, double> response_differences(
    const recording::Reader& run, const recording::Reader& numerical);

/// How late the host of a run in real time was, as "up to 45 ms late, …"; empty if it kept real
/// time.   @setup
[[nodiscard]] std::string late_host_in(const recording::Reader& run);

/// What was late in the half second before a safety trip: a node, or else a target; empty if
/// nothing was, or if nothing tripped.   @setup
[[nodiscard]] std::string lateness_before_trip(const recording::Reader& run);

/// The broken conditions as lines for a terminal; empty if there are none.
[[nodiscard]] std::string verdict_of(const std::vector<Broken>& conditions);

}  // namespace rths::report
