// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rths::recording {

/// Named columns of equal length, as some laboratory's logger left them; no units are known.
class Table {
 public:
  struct Column {
    std::string name;
    std::vector<double> values;  ///< NaN where there is no number
    std::string trouble;         ///< place of the first such cell; empty: none
  };

  /// Reads a file by its content:
  /// - text: columns separated by commas, semicolons, tabs or blanks, with a row of names or
  ///   without (columns are then called 1, 2, …), decimal points, lines ended by LF, CR LF or CR;
  ///   lines that begin with # or % are comments; more text may stand above the names, and units
  ///   below them;
  /// - HDF5: every numeric dataset of one or two dimensions, named by its path; columns of a
  ///   recording of our own by the names of its signals, and "time";
  /// - MAT, versions 4 to 7.3: every numeric array, fields of structures by name.field; an array
  ///   with several columns gives name(1), name(2), …
  /// @throws Error file:line, what was found and what was expected   @setup
  [[nodiscard]] static Table load(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// A column by its name, or by its place: "#3".
  /// @throws Error with the nearest known name, or with the place of a cell that is no number
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
  /// The same, with NaN where there is no number.
  [[nodiscard]] const std::vector<double>& column_with_gaps(const std::string& name) const {
    return found(name).values;
  }

 private:
  [[nodiscard]] const Column& found(const std::string& name) const;

  std::string file_;
  std::vector<Column> columns_;
};

}  // namespace rths::recording
