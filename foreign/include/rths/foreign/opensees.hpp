// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rths/foreign/program.hpp>

namespace rths::foreign {

/// A simulation that is a Python script for OpenSees.
struct OpenSeesRunSettings {
  std::string python;                        ///< see `opensees_python`
  std::filesystem::path script;              ///< full path
  std::vector<std::string> arguments;        ///< with placeholders
  std::vector<std::filesystem::path> files;  ///< copied beside each run
  std::string function;                      ///< of the script; empty: the script itself runs
  std::vector<std::string> inputs, parameters;
  std::vector<std::string> outputs;      ///< names of what the function or outputs.csv returns
  std::vector<RecorderColumn> recorded;  ///< in place of `outputs`, if not empty
  double deadline = 60;                  ///< of one run [s]
};

/// As `make_program`, for an unmodified script. Further placeholders in an argument:
///     {motion}      file of time from 0 on [s] and the inputs, separated by spaces
///     {step_s}, {duration_s}   of the inputs [s]
///     {results}     start of a path in the folder of the run
///     {NAME}        of an input: file of its values, one per line
/// With `function`, it is called as function(time, inputs, parameters): a list, and two
/// dictionaries by name. It returns a dictionary of outputs, with "time" if its times are others.
/// @throws Error as make_program   @setup
[[nodiscard]] std::unique_ptr<Simulation> make_opensees(OpenSeesRunSettings settings);

/// The interpreter that has OpenSees: RTHS_OPENSEES_PYTHON, otherwise python3.
[[nodiscard]] std::string opensees_python();

}  // namespace rths::foreign
