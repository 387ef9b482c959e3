// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <any>
#include <deque>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include <rths/command_line/program.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::app {

/// The command line of rths. Each command adds itself with its options and what runs if it is
/// chosen.
struct CommandLine {
  CLI::App& app;
  Chosen chosen = {};
  std::deque<std::any> kept = {};  ///< values of options; they outlive the parser

  /// Adds a command to those of rths.
  /// @param prepare  completes the values when all are parsed; null: nothing to do
  /// @returns the command, and the values of its options
  template <class Values>
  std::pair<CLI::App*, Values&> add(const std::string& name, const std::string& description,
                                    int (*work)(const Values&),
                                    std::type_identity_t<void (*)(Values&)> prepare = nullptr) {
    return add_to(app, name, description, work, prepare);
  }

  /// Adds a command to those of a group.
  template <class Values>
  std::pair<CLI::App*, Values&> add_to(CLI::App& group, const std::string& name,
                                       const std::string& description, int (*work)(const Values&),
                                       std::type_identity_t<void (*)(Values&)> prepare = nullptr) {
    auto& values = *std::any_cast<Values>(&kept.emplace_back(Values{}));
    auto* command = group.add_subcommand(name, description);
    command->callback([this, work, prepare, &values] {
      if (prepare != nullptr) prepare(values);
      chosen = [work, &values] { return work(values); };
    });
    return {command, values};
  }
};

/// Checks that a number is at least 0. CLI11's own message has the largest number in 300 digits.
[[nodiscard]] inline CLI::Validator not_negative() {
  return {[](const std::string& text) {
            double value = 0;
            const bool is_good = CLI::detail::lexical_cast(text, value) && value >= 0;
            return is_good ? std::string{} : "found " + text + ", expected a number of at least 0";
          },
          "NONNEGATIVE"};
}

/// Lets an option be given more than once, with one value each time.
template <class Option>
Option* repeatable(Option* option) {
  return option->take_all()->allow_extra_args(false);
}

/// Changes to an experiment file: dotted key, value.
using Changes = std::vector<std::pair<std::string, std::string>>;

/// Splits "key=value". @throws CLI::ValidationError
[[nodiscard]] Changes split_changes(const std::vector<std::string>& sets);

/// Prints what is unusual about an experiment, a line each on standard error.
/// @throws Error if it is implausible
void check_sizes(const experiment::Experiment& experiment);

/// Prints what a map has. @throws Error for a wrong one
[[nodiscard]] int map_check(const std::string& file);

/// Version of the program, for recordings.
[[nodiscard]] std::string version();

// Each adds the command of its name, a file of its own or of its group.
void add_run(CommandLine& line);
void add_node(CommandLine& line);
void add_check(CommandLine& line);
void add_export(CommandLine& line);
void add_report(CommandLine& line);
void add_compare(CommandLine& line);
void add_diagnose(CommandLine& line);
void add_loop(CommandLine& line);
void add_terms(CommandLine& line);
void add_plant(CommandLine& line);
void add_map(CommandLine& line);
void add_new(CommandLine& line);
void add_replay(CommandLine& line);
void add_play(CommandLine& line);
void add_record(CommandLine& line);
void add_test(CommandLine& line);
void add_dump(CommandLine& line);
void add_view(CommandLine& line);
void add_top(CommandLine& line);
void add_who(CommandLine& line);
void add_watch(CommandLine& line);
void add_send(CommandLine& line);
void add_bridge(CommandLine& line);
void add_ring(CommandLine& line);
void add_fault(CommandLine& line);
void add_stop(CommandLine& line);
void add_doctor(CommandLine& line);
void add_clean(CommandLine& line);
void add_bench(CommandLine& line);
void add_delay(CommandLine& line);
void add_identify(CommandLine& line);
void add_calibrate(CommandLine& line);
void add_pretest(CommandLine& line);

/// Becomes rths-bench, the program of the benchmarks beside this one, if the words are `bench …` or
/// complete such words. @throws Error if it is not there
void become_bench(const std::vector<std::string>& words);

}  // namespace rths::app
