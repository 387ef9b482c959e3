// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/memmap/units.hpp>
#include <rths/recording/table.hpp>

namespace rths::diagnosis {

/// Source of a channel's numbers. Forms in case.toml:
///     "F [kN]"                a column of the record's file and its unit
///     "-F [kN]"               the same with the opposite sign
///     "F [35.15065 N]"        a unit with a factor
///     "= 0.25 [A]"            a known constant that was not recorded
///     "F [kN] in load.csv"    a column of another file
struct Source {
  std::string key;  ///< in case.toml, for messages
  std::string column;
  std::string whole;             ///< column and unit as written: the name in some files
  std::optional<double> number;  ///< instead of a column [SI]
  memmap::Unit unit{"1", 1, 0};
  std::string unit_text;  ///< as written
  std::string file;       ///< empty: the record's file
};

/// @throws Error with the position of `key`   @setup
[[nodiscard]] Source source_of(const Config& table, const std::string& key);
/// "2.5 [kN]": a standard deviation [SI] and its SI unit.
/// @throws Error with the position of `key`   @setup
[[nodiscard]] std::pair<double, std::string> deviation_of(const Config& table,
                                                          const std::string& key);

/// The first cell of a column that is not a finite number; an empty text: there is none, or its
/// place is not known.
struct Trouble {
  std::string text;        ///< "file:line: found, expected"
  std::ptrdiff_t row = 0;  ///< from 0
};

/// Cache of files: several records may be slices of one file.
class Files {
 public:
  [[nodiscard]] const recording::Table& at(const std::filesystem::path& file);
  /// A column in SI units, with NaN for cells without a finite number.
  /// @throws Error with the position of the source's key   @setup
  [[nodiscard]] std::vector<double> column(const Config& table, const Source& source,
                                           const std::filesystem::path& file, Trouble& trouble);
  /// The files that were read.
  [[nodiscard]] std::vector<std::filesystem::path> paths() const;

 private:
  std::map<std::filesystem::path, recording::Table> tables_;
};

}  // namespace rths::diagnosis
