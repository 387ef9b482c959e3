// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/foreign/program.hpp>

namespace rths::foreign {

/// The table of inputs: "time" [s], then a column for each name.
[[nodiscard]] std::string table_of_inputs(const RunInputs& inputs,
                                          const std::vector<std::string>& names);

/// Reads the table of outputs, at the times of the inputs.
/// @throws Error if the file cannot be read, lacks a column, or has a cell that is not a finite
///         number, other rows without times, or times that do not cover those of the inputs
[[nodiscard]] std::vector<std::vector<double>> read_outputs(const std::filesystem::path& file,
                                                            const std::vector<std::string>& names,
                                                            const RunInputs& inputs);

/// Reads files of recorders, at the times of the inputs, of which the first is their time 0. What
/// was recorded before the time last fell, as in a static analysis, is ignored. A recorder begins
/// after the first step: the values there are those of its first row.
/// @throws Error as `read_outputs`
[[nodiscard]] std::vector<std::vector<double>> read_recorders(
    const std::filesystem::path& folder, const std::vector<RecorderColumn>& columns,
    const RunInputs& inputs);

}  // namespace rths::foreign
