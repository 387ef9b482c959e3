// SPDX-License-Identifier: Apache-2.0
//
// Commands before a test: delay, identify, calibrate, pretest.
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/command_line/write_file.hpp>
#include <rths/commissioning/calibration.hpp>
#include <rths/commissioning/delay_report.hpp>
#include <rths/commissioning/empty_table_run.hpp>
#include <rths/commissioning/learnt_inverse.hpp>
#include <rths/core/error.hpp>
#include <rths/session/folder.hpp>
#include <rths/session/pretest.hpp>

#include "command.hpp"
#include "temporary_folder.hpp"

namespace rths::app {
namespace {

/// Of the commands before a test: delay, identify, calibrate, pretest.
struct CommissioningArguments {
  std::vector<std::string> files;  ///< recordings, or folders of runs
  bool json = false;
  std::optional<std::string> out;  ///< TOML file for the constants
  // delay
  std::string target = "command", measured = "displacement";  ///< roles, or names of signals
  double window = 2, search = 0.2;                            ///< [s]
  double least_rms = 5e-4;  ///< of the target's motion, in its unit
  // identify empty-table
  double load = std::numeric_limits<double>::quiet_NaN();  ///< [N]; NaN: that of the recordings
  std::string block = "observer", observer = "force_observer";
  std::string inverse = "inverse";  ///< block of `identify inverse`
  // calibrate
  std::vector<double> band{0.1, 3};  ///< [Hz]
  double feed_forward_share = 1.0 / 3;
  // pretest
  std::string machine;            ///< recording of the machine; empty: the virtual one
  std::vector<std::string> sets;  ///< key=value
};

// A recording that is given twice, or a copy of it, would halve the variance of each estimate.
std::vector<std::filesystem::path> recordings_of(const std::vector<std::string>& files) {
  std::vector<std::filesystem::path> paths;
  std::vector<recording::Reader> runs;
  for (const auto& file : files) {
    const auto path = session::recording_in(file);
    recording::Reader run{path};
    for (std::size_t i = 0; i < paths.size(); ++i) {
      std::error_code ignored;
      if (std::filesystem::equivalent(paths[i], path, ignored))
        throw Error{path.string() + ": is given twice, expected different recordings"};
      if (recording::hold_same_signals(runs[i], run))
        throw Error{fmt::format("{}: holds the same signals as {}, expected different recordings",
                                path.string(), paths[i].string())};
    }
    paths.push_back(path);
    runs.push_back(std::move(run));
  }
  return paths;
}

template <class Found>
void print(const CommissioningArguments& a, const Found& found) {
  fmt::print("{}", a.json ? json_of(found) : text_of(found));
}

int delay(const CommissioningArguments& a) {
  commissioning::DelayQuestion question;
  question.target = a.target;
  question.measured = a.measured;
  question.window = a.window;
  question.search = a.search;
  question.least_rms = a.least_rms;
  const auto file = session::recording_in(a.files.at(0));
  const auto pairs = recording::of_file(
      file, [&] { return commissioning::track(recording::Reader{file}, question); });
  print(a, pairs);
  return kOk;
}

int identify_empty_table(const CommissioningArguments& a) {
  if (a.out) check_target(*a.out);
  const auto runs = commissioning::identify_empty_table(recordings_of(a.files), a.load);
  print(a, runs);
  if (a.out) write_file(*a.out, commissioning::toml_of(runs, a.block, a.observer));
  return kOk;
}

int identify_inverse(const CommissioningArguments& a) {
  if (a.out) check_target(*a.out);
  const auto found = commissioning::learnt_inverse(recordings_of(a.files), a.inverse);
  print(a, found);
  if (a.out) write_file(*a.out, commissioning::toml_of(found));
  return kOk;
}

int calibrate(const CommissioningArguments& a) {
  if (a.out) check_target(*a.out);
  const auto found = commissioning::calibrate(recordings_of(a.files),
                                              {a.band.at(0), a.band.at(1), a.feed_forward_share});
  print(a, found);
  if (a.out) write_file(*a.out, commissioning::toml_of(found));
  return kOk;
}

int pretest(const CommissioningArguments& a) {
  const auto experiment = load_experiment(a.files.at(0), split_changes(a.sets));
  check_sizes(experiment);
  std::optional<TemporaryFolder> temporary;
  session::PretestSettings settings;
  if (a.out)
    session::create_folder(settings.folder = *a.out);
  else
    settings.folder = temporary.emplace("pretest").path();
  if (!a.machine.empty()) settings.machine = session::recording_in(a.machine);
  settings.version = version();
  const auto result = session::pretest(experiment, settings);
  print(a, result);
  return result.is_go() ? kOk : kConditionNotMet;
}

}  // namespace

void add_delay(CommandLine& line) {
  auto [command, a] = line.add(
      "delay", "Delay, gain and error of a measured signal behind its target, with intervals",
      delay);
  command->add_option("recording", a.files, "Recording, or folder of a run")
      ->required()
      ->expected(1);
  command->add_option("--target", a.target, "Role of an axis, or name of a signal")
      ->capture_default_str();
  command->add_option("--measured", a.measured, "Role of an axis, or name of a signal")
      ->capture_default_str();
  command->add_option("--window-s", a.window, "Length of the windows")
      ->check(CLI::Range(0.1, 1000.0))
      ->capture_default_str();
  command->add_option("--search-s", a.search, "Largest delay to either side")
      ->check(CLI::Range(0.002, 10.0))
      ->capture_default_str();
  command
      ->add_option("--least-rms", a.least_rms,
                   "Least motion of the target, RMS, in its SI unit; less is refused")
      ->check(not_negative())
      ->capture_default_str();
  command->add_flag("--json", a.json, "One JSON document instead of tables");
}

void add_identify(CommandLine& line) {
  auto* command = line.app.add_subcommand("identify", "Identify a machine from recordings");
  command->require_subcommand(1);
  auto [table, a] =
      line.add_to(*command, "empty-table",
                  "Mass, friction and offsets of a machine that moved without a specimen",
                  identify_empty_table);
  table->add_option("recordings", a.files, "Recordings, or folders of runs; fitted together")
      ->required();
  table->add_option("--load-N", a.load,
                    "Vertical load for which Coulomb friction is stated [mean of the recordings]");
  table->add_option("--block", a.block, "Block of the diagram that gets the constants")
      ->capture_default_str();
  table
      ->add_option("--observer", a.observer,
                   "Type of that block; a table_force_observer knows friction by vertical load")
      ->check(CLI::IsMember({"force_observer", "table_force_observer"}))
      ->capture_default_str();
  table->add_option("--out", a.out, "Write the constants to this TOML file");
  table->add_flag("--json", a.json, "One JSON document instead of tables");
  auto [inverse, b] =
      line.add_to(*command, "inverse",
                  "Initial coefficients of an adaptive inverse, from runs in which it learnt",
                  identify_inverse);
  inverse->add_option("recordings", b.files, "Recordings, or folders of runs; averaged")
      ->required();
  inverse->add_option("--block", b.inverse, "Block of the diagram that learnt")
      ->capture_default_str();
  inverse->add_option("--out", b.out, "Write the coefficients to this TOML file");
  inverse->add_flag("--json", b.json, "One JSON document instead of tables");
}

void add_calibrate(CommandLine& line) {
  auto [command, a] = line.add(
      "calibrate", "Gains of the compensation, from characterisation tests without it", calibrate);
  command->add_option("recordings", a.files, "Recordings, or folders of runs")->required();
  command->add_option("--band-Hz", a.band, "Lowest and highest frequency of the fit")
      ->expected(2)
      ->check(CLI::Range(0.01, 100.0))
      ->capture_default_str();
  command
      ->add_option("--feed-forward-share", a.feed_forward_share,
                   "Part of the lag that the feed-forward compensates")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->add_option("--out", a.out, "Write the gains to this TOML file");
  command->add_flag("--json", a.json, "One JSON document instead of lines");
}

void add_pretest(CommandLine& line) {
  auto [command, a] = line.add(
      "pretest", "Try out a test with a numerical specimen: signals, stability, go or no-go",
      pretest);
  command->add_option("experiment", a.files, "Experiment file")->required()->expected(1);
  command->add_option("--machine", a.machine,
                      "Recording of the real machine, which is identified [the virtual machine]");
  command->add_option("--out", a.out,
                      "Folder for the recordings of the first two runs [none is kept]");
  repeatable(command->add_option("--set", a.sets, "Override a key of the experiment: key=value"));
  command->add_flag("--json", a.json, "One JSON document instead of lines");
}

}  // namespace rths::app
