// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/maths/bands.hpp>
#include <rths/maths/delay.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>
#include <rths/report/judgement.hpp>

namespace rths::report {

using recording::AxisRoles, recording::Reader, recording::Roles, recording::at_each_count;

/// Values equally spaced in time.
struct Series {
  double start = 0;     ///< time of the first value [s]
  double interval = 0;  ///< [s]
  std::vector<double> values;
};

/// The value of largest magnitude, with its sign; none without values.
[[nodiscard]] std::optional<double> most_extreme(std::span<const double> values);

/// Tracking in a sliding window; NaN where the command hardly moves.
struct WindowedTracking {
  Series delay;  ///< [s]
  Series nrms;   ///< RMS error of the window over the largest command of the run [-]
};

/// One axis of a hybrid test, in SI.
struct AxisAnalysis {
  std::string name;
  Series command, measured;  ///< controller's command and displacement feedback, every tick [m]
  Series force;              ///< of the specimen, corrected, every tick [N]
  Series a0, a1, a2;         ///< compensator, every tick
  std::vector<double> step_displacement, step_force;   ///< sampled at each target [m], [N]
  double delay = 0, delay_min_rms = 0;                 ///< command to measured [s]
  double nrms = 0, peak_error = 0;                     ///< [-]
  std::optional<double> raw_delay, raw_delay_min_rms;  ///< without compensation [s]
  std::optional<double> raw_nrms;
  double peak_displacement = 0, peak_shear = 0;  ///< [m], [N]
  long compensator_limited = 0;                  ///< its ticks at a limit
  WindowedTracking tracking;
  std::vector<maths::BandTracking> bands;
};

/// States of the predictor-corrector in each integration step.
struct StepAnalysis {
  std::vector<double> start;                   ///< arrival of its target [s]
  std::vector<double> predict, correct, slow;  ///< time in each state [s]
  std::vector<bool> excused;                   ///< true if the host was late during the step
  long slow_downs = 0, slow_downs_excused = 0;
  long excused_count = 0;
};

struct NodeAnalysis {
  std::string name;
  long steps = 0, overruns = 0, stale = 0;
  double late_p50 = 0, late_p99 = 0, late_max = 0;  ///< [s]
};

/// Updates of a node on another host of the test.
struct HopAnalysis {
  std::string from, to;                                ///< node, host
  double delay_p50 = 0, delay_p99 = 0, delay_max = 0;  ///< from sending to the ring of the host [s]
  double age_p99 = 0, age_max = 0;                     ///< of the words on that host [s]
};

/// A floor spectrum and its source.
struct FloorSpectrum {
  std::string of;              ///< hybrid, numerical, improved, fixed base, input, beside
  std::vector<double> values;  ///< [m/s²]
};
struct FloorSpectra {
  std::string floor;
  std::vector<FloorSpectrum> spectra;
};

/// Result of a run with a model instead of the specimen, one per axis.
struct NumericalAxis {
  std::string name;
  std::vector<double> displacement, force;  ///< [m], [N]
  double peak_displacement = 0, peak_shear = 0;
  double difference = 0;  ///< of its displacement from the test's, rms over rms of the test [-]
};

/// Another test in the figures of this one.
inline constexpr const char* kBeside = "beside";
struct Beside {
  std::string name, folder;
  double rate = 1;     ///< its wall time over model time
  std::string ending;  ///< why it ended early; empty: it was completed
  double integration_step = 0;
  std::vector<NumericalAxis> axes;  ///< at each of its targets
};

/// Vertical force of a test whose controller controls it, in model time.
struct VerticalAnalysis {
  Series command, measured;  ///< on the specimen, every tick of the controller [N]
  double span = 0;           ///< of the command, peak to peak [N]
  double delay = 0;          ///< command to measured [s]
  double error = 0;          ///< RMS error over span [-]
  maths::Coherence coherence;
  std::vector<maths::BandTracking> bands;
};

/// A change of a word that no node of the run writes, such as a parameter.
struct OperatorChange {
  double time = 0;  ///< since the run began [s]
  std::string signal, unit;
  double from = 0, to = 0;  ///< [SI]
};

/// A section that a report does not have, and the reason.
struct LeftOut {
  std::string section;  ///< "tracking", "compensation", …: docs/experiments.md lists them
  std::string reason;
};

/// A state that the safety layer entered, or its trip.
struct SafetyChange {
  double time = 0;    ///< since the run began [s]
  std::string state;  ///< "running", "hold", …, or "trip"
  std::string text;   ///< of a trip: its cause
};

/// Facts of the experiment, and the ending of the run.
struct RunDescription {
  std::map<std::string, std::string> meta;
  std::string name, motion, clock;
  std::string ending;                           ///< why the run ended early; empty: completed
  std::string command;                          ///< repeats the run
  bool synthetic = false;                       ///< specimen and machine are models
  std::vector<std::string> scope;               ///< sentences: tested, simulated, assumed
  std::map<std::string, double> stated_bounds;  ///< of [conclusive]
  double planned_duration = 0;                  ///< model time [s]
  double integration_step = 0;                  ///< in model time [s]
  double rate = 1;                              ///< wall time over model time, as planned
  double rest = 0;                              ///< wall time before the test [s]
  std::optional<double> spectrum_elevation;     ///< of floors of sticks [m]
};

/// Times and rates that the run reached.
struct RunTiming {
  double duration = 0;                  ///< model time [s]
  double control_rate = 0;              ///< [Hz]
  std::optional<double> achieved_rate;  ///< wall time over model time
};

/// How processes and hosts served the run.
struct HostAnalysis {
  int processes = 1;
  std::string real_time;  ///< how late the host was in real time; empty: not repeated
  Series late;            ///< largest of each interval [s]; empty in virtual time
  std::vector<NodeAnalysis> nodes;
  std::vector<HopAnalysis> hops;  ///< of a test on several hosts in real time
  std::vector<std::pair<std::string, std::int64_t>> drops;
  std::int64_t rows_missing = 0;  ///< of the recording
};

/// Results of the analysed axes with a model instead of the specimen.
struct CompanionAnalysis {
  std::vector<NumericalAxis> numerical;
  std::vector<NumericalAxis> improved;  ///< with the improved model of a diagnosis
  double interval = 0;                  ///< [s]
};

struct SpectraAnalysis {
  std::vector<double> frequencies;  ///< [Hz]
  std::vector<FloorSpectra> floors;
};

/// A large structure, and the loads of its bearings during the test.
struct StructureAnalysis {
  std::string sketch;                  ///< JSON, as recorded; empty: none
  double interval = 0;                 ///< of the loads [s]
  std::vector<double> least, largest;  ///< load of any bearing at each target [N]
  double lifted = 0;                   ///< most bearings that pulled at a time
};

struct Analysis {
  RunDescription test;
  RunTiming timing;
  std::vector<AxisAnalysis> axes;
  StepAnalysis steps;
  std::optional<VerticalAnalysis> vertical;
  HostAnalysis hosts;
  std::vector<OperatorChange> changes;
  std::vector<SafetyChange> safety;  ///< none: the machine has no safety layer
  CompanionAnalysis companions;
  SpectraAnalysis spectra;
  StructureAnalysis structure;
  std::vector<LeftOut> left_out;  ///< sections
  std::optional<Beside> beside;
  std::vector<Broken> broken;  ///< conditions of a conclusive test; none: the test is conclusive
};

/// @throws Error if the run cannot be read or contains no motion
[[nodiscard]] Analysis analyse(const std::filesystem::path& folder);

/// Number of targets until each row: as controller or solver count them, or else the changes of
/// target and flag, of which rows can miss some. Empty if the recording has neither.
[[nodiscard]] std::vector<double> targets_of(const Reader& run, const Roles& roles);

[[nodiscard]] RunDescription describe(const Reader& run);

/// Hops of updates between the hosts of a test, from the signals of their gateways.
[[nodiscard]] std::vector<HopAnalysis> analyse_hops(const Reader& run);
/// Name of the host of a gateway's signals: "lab" of partition "gateway.lab"; empty for others.
[[nodiscard]] std::string host_of_gateway(const std::string& partition);

/// Changes of words that no node of the run writes, in order of time. A word that changes often is
/// data of another program and not listed.
[[nodiscard]] std::vector<OperatorChange> operator_changes(const Reader& run);

/// States and trip of the safety layer, in order of time.
[[nodiscard]] std::vector<SafetyChange> safety_changes(const Reader& run);

/// Floor spectra of the run and its companions, null if not recorded. No floors: the solver records
/// none.
/// @param step  of the solver [s]
[[nodiscard]] SpectraAnalysis analyse_spectra(const Reader& run, const std::string& solver,
                                              double step, const Reader* numerical,
                                              const Reader* improved);

/// Largest delay that is looked for in a whole test [s].
inline constexpr double kDelaySearch = 0.2;
/// NaN if the signals have no motion, or are too short.
/// @param search  largest shift to either side [s]
[[nodiscard]] maths::DelayIdentification delay_or_none(std::span<const double> command,
                                                       std::span<const double> measured,
                                                       double interval, double search);

/// Lateness of the host, as recorded.
struct RecordedLateness {
  Series late;        ///< largest of each interval [s]; empty in virtual time
  double period = 0;  ///< control period: a late host excuses from here on [s]
  /// Returns true if the lateness reached a control period in [from, to].
  [[nodiscard]] bool was_late(double from, double to) const;
};
/// The control period is that of the recording; without steps of a controller, 1 ms.
[[nodiscard]] RecordedLateness lateness_of(const Reader& run);

/// Model time at a wall time since the run began [s].
/// @param rest  wall time before the test [s]   @param rate  wall time over model time
[[nodiscard]] double model_time_at(double wall_time, double rest, double rate);

/// 0 if there are none.
[[nodiscard]] double largest(const std::vector<double>& values);

/// The lines of a text that each end with a line feed.
[[nodiscard]] std::vector<std::string> lines(const std::string& text);

}  // namespace rths::report
