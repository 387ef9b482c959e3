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
    /// Other name, as MATLAB writes it: "X(:,2)", "X(2,:)"; or empty.
    std::string slice = {};  // NOLINT(readability-redundant-member-init): as `unit`
    /// As a row below the names states it; or empty. Initializers may leave it out.
    std::string unit = {};  // NOLINT(readability-redundant-member-init)
  };

  /// Reads a file; its content decides the format:
  /// - text: columns separated by commas, semicolons, tabs or blanks, with a row of names or
  ///   without (columns are then named 1, 2, …), decimal points, or commas where nothing else
  ///   has them, lines ended by LF, CR LF or CR; lines that begin with # or % are comments; text
  ///   above the names and units below them are skipped;
  /// - LVM of LabVIEW: the channels by name; "X_Value", also of files without X values;
  /// - HDF5: every numeric dataset of one or two dimensions, named by its path; members of
  ///   compounds as path.member; in a recording of a run, the signals by name, and "time";
  /// - MAT, versions 4 to 7.3: every numeric array by its name, fields of structures as
  ///   name.field, elements of their arrays as name(2).field, cells as name{2}.
  /// A matrix gives name(1), name(2), …: its columns, or its rows if they are longer.
  /// @throws Error with file:line, found and expected   @setup
  [[nodiscard]] static Table load(const std::filesystem::path& file);
  /// Whether the format of a file is one of tables alone: MAT, LVM, HDF5 without a run.
  [[nodiscard]] static bool is_format_of(const std::filesystem::path& file);

  [[nodiscard]] const std::vector<Column>& columns() const { return columns_; }
  /// A column by name, or by position: "#3". An index (1) of a single element may be left out.
  /// @throws Error with the most similar known name, or with the place of a cell that is not a
  ///         finite number
  [[nodiscard]] const std::vector<double>& column(const std::string& name) const;
  /// The same, with NaN for cells that are not a finite number.
  [[nodiscard]] const Column& column_with_gaps(const std::string& name) const;

 private:
  std::string file_;
  std::vector<Column> columns_;
};

}  // namespace rths::recording
