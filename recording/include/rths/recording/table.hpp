// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rths::recording {

/// Named columns of equal length from the file of any data logger; without units.
class Table {
 public:
  struct Column {
    std::string name;
    std::vector<double> values;  ///< NaN for cells that are not a finite number
    std::string trouble;         ///< error message for the first such cell; empty: none
  };

  /// Reads a file; its content decides the format:
  /// - text: columns separated by commas, semicolons, tabs or blanks, with a row of names or
  ///   without (columns are then named 1, 2, …), decimal points, lines ended by LF, CR LF or CR;
  ///   lines that begin with # or % are comments; text above the names and units below them are
  ///   skipped;
  /// - HDF5: every numeric dataset of one or two dimensions, named by its path; in a recording
  ///   of a run, the signals by name, and "time";
  /// - MAT, versions 4 to 7.3: every numeric array, fields of structures as name.field; an array
  ///   with several columns gives name(1), name(2), …
  /// @throws Error with file:line, found and expected   @setup
  [[nodiscard]] static Table load(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// A column by name, or by position: "#3".
  /// @throws Error with the most similar known name, or with the place of a cell that is not a
  ///         finite number
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
  /// The same, with NaN for cells that are not a finite number.
  [[nodiscard]] const std::vector<double>& column_with_gaps(const std::string& name) const {
    return found(name).values;
  }

 private:
  [[nodiscard]] const Column& found(const std::string& name) const;

  std::string file_;
  std::vector<Column> columns_;
};

}  // namespace rths::recording
