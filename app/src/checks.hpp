// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace rths::app {

/// Smallest and largest value; of time that is equally spaced, also the step.
[[nodiscard]] std::string range_of(const std::vector<double>& values);

/// Prints the columns of a file that a case can name.
int check_table(const std::string& file);

/// Prints format, time step, and the unit and peak of each column of a file of ground motion. A
/// text file whose headings name other quantities is a table.
/// @throws Error as a test with this file
int check_columns(const std::string& file);

[[nodiscard]] int map_check(const std::string& file);

}  // namespace rths::app
