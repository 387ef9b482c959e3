// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rths/foreign/simulation.hpp>

namespace rths::foreign {

/// A column of a file that a recorder of OpenSees writes: rows of time [s] and responses.
struct RecorderColumn {
  std::string file;        ///< from the folder of the run
  std::size_t column = 1;  ///< response, from 1
  double factor = 1;       ///< to SI
};

/// A simulation that is a program: it reads a table of inputs and writes a table of outputs.
struct ProgramSettings {
  std::vector<std::string> command;  ///< program and arguments, with placeholders
  std::filesystem::path folder;      ///< relative paths in the command start here
  std::vector<std::string> inputs, outputs, parameters;  ///< names of columns and parameters
  double deadline = 60;                                  ///< of one run [s]
  std::vector<std::filesystem::path> files = {};         ///< copied to the folder of each run
  std::vector<RecorderColumn> recorded = {};             ///< by output, in place of outputs.csv
  bool has_motion = false;  ///< the placeholders of `make_opensees` too
  /// If the program is Python: its script. An interpreter then loads once what the script imports,
  /// and each run is a fork of it. The first two runs start anew; if a fork returns other outputs
  /// than the first of them, all runs do.
  std::filesystem::path python_script = {};
};

/// Each run has an empty folder of its own, in which the program starts:
///     inputs.csv       the column "time" [s] and the inputs, one row per sample
///     parameters.toml  the parameters by name
///     outputs.csv      written by the program: the outputs by name in any order, and "time" if its
///                      rows are other times; they are then interpolated linearly
/// The placeholders {inputs}, {outputs}, {parameters} in an argument stand for the full paths of
/// these files, {name} for the value of a parameter. No shell is involved. An argument that is a
/// file below `folder` becomes its full path. A run that ends, fails or is interrupted leaves no
/// process of its process group.
/// @throws Error if the command is empty, its program cannot be executed, or a placeholder is
///         unknown   @setup
[[nodiscard]] std::unique_ptr<Simulation> make_program(ProgramSettings settings);

}  // namespace rths::foreign
