// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/bench/machine.hpp>

namespace rths::bench {

struct SrmdOptions {
  int draws = 2;                  ///< members of the family besides the nominal machine, 0…200
  int records = 3;                ///< of the list below, 1…3
  double duration = 30;           ///< of a test, model time [s]
  std::filesystem::path machine;  ///< file of the nominal machine
  std::filesystem::path bearing;  ///< file of the specimen
  /// File of constants of the adaptive controller, identified on the nominal machine.
  std::filesystem::path constants;
  std::filesystem::path records_folder;
  int jobs = 1;                   ///< tests at one time, ≥ 1
  std::filesystem::path partial;  ///< file of finished tests, for an interrupted run; empty: none
  std::function<void(const std::string& stage)> progress;  ///< called after each test
};

/// Figures of one axis under one controller.
struct SrmdAxis {
  std::string name;                   ///< "long" or "lat"
  double largest = 0;                 ///< command [m]
  double raw_delay = 0;               ///< of the same commands without compensation [s]
  double delay = 0;                   ///< of the whole test, by cross-correlation [s]
  std::vector<double> windows;        ///< delay in each window of 2 s of strong motion [s]
  double nrms = 0, peak = 0;          ///< tracking error over largest command [-]
  double feed_forward_overshoot = 0;  ///< with feed-forward alone: largest response/command − 1 [-]
  double share_a0_below_1 = 0;        ///< of the samples after the rest [-]
  double lowest_a1 = 0, highest_a1 = 0;  ///< [s]
};

/// One hybrid test under one controller.
struct SrmdTest {
  std::string controller;
  bool stable = true;          ///< no stroke was reached
  long limit_periods = 0;      ///< with a limit of Table 1 reached
  std::vector<SrmdAxis> axes;  ///< empty if unstable
  /// Floor spectra at 6 to 11 Hz against the loop with an ideal machine: rms over the frequencies
  /// of the relative difference, at the worst floor [-].
  double floor_error = 0;
};

/// The tests of one machine under one record.
struct SrmdRow {
  int member = 0;  ///< of the family; 0: nominal
  std::string record;
  std::vector<SrmdTest> tests;  ///< one per controller
};

struct SrmdReport {
  Machine host;
  SrmdOptions options;
  std::vector<SrmdRow> rows;
  double step_p50 = 0, step_p99 = 0, step_worst = 0;  ///< of the machine's step of 1 ms [s]
};

/// Runs hybrid tests on the machine with six degrees of freedom in virtual time. Tests that an
/// interrupted run of this program has finished are taken from `options.partial`.
/// @throws Error if a file cannot be read, an option is out of range, or `options.partial` belongs
///         to another program or other options   @setup
[[nodiscard]] SrmdReport run_srmd_bench(const SrmdOptions& options);

/// The report as one JSON document, or as tables of text.
[[nodiscard]] std::string to_json(const SrmdReport& report);
[[nodiscard]] std::string to_text(const SrmdReport& report);

}  // namespace rths::bench
