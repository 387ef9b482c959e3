// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <any>
#include <deque>
#include <string>
#include <utility>
#include <vector>

#include <rths/command_line/program.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::app {

/// The command line of rths. Each command adds itself with its options, and sets what runs if it is
/// chosen.
struct CommandLine {
  CLI::App& app;
  Chosen chosen = {};
  std::deque<std::any> kept = {};

  /// Values of the options of a command; they outlive the parser.
  template <class Values>
  Values& values() {
    return *std::any_cast<Values>(&kept.emplace_back(Values{}));
  }
};

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

/// Version of the program, for recordings.
[[nodiscard]] std::string version();

}  // namespace rths::app
