// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace rths::sim {

/// A unit in which files state motions.
struct MotionUnit {
  enum class Kind { Acceleration, Velocity, Displacement, Other };

  std::string_view name;
  Kind kind = Kind::Acceleration;
  double per_g = 1;  ///< how many make 1 g; of an acceleration
};
inline constexpr MotionUnit kUnitG{"g", MotionUnit::Kind::Acceleration, 1};

/// The unit with a name in any spelling, such as "cm/sec^2" or "GAL"; null: unknown.
[[nodiscard]] const MotionUnit* find_unit(std::string_view name);

/// The unit that the heading of a column states, such as "ns [gal]", "h1_m/s2" or "EW, cm/s²".
struct StatedUnit {
  const MotionUnit* unit = nullptr;  ///< null: none, or unknown
  std::string unknown;               ///< as written; empty: none, or known
};
[[nodiscard]] StatedUnit stated_unit(std::string_view heading);

/// One component of a record.
struct RecordComponent {
  double time_step = 0;        ///< [s]
  std::vector<double> values;  ///< in the file's unit
  std::string heading;         ///< of the column, or the unit that an .AT2 file states; or empty
};

/// A column of values in a file, with the unit that its heading states.
struct MotionColumn {
  std::string heading;  ///< may be empty
  StatedUnit stated;
  std::vector<double> values;  ///< in the file's unit
};

/// A file of one or more components, equally spaced in time.
struct MotionFile {
  std::filesystem::path file;
  std::string format;                 ///< ".AT2", "K-NET", "COSMOS", …, or "columns"
  double time_step = 0;               ///< [s]; 0: the file states none
  std::vector<MotionColumn> columns;  ///< without that of time; at least one
  std::size_t first_line = 1;         ///< of the values, from 1
  bool has_channels = false;          ///< columns are the channels of a station, in any order

  [[nodiscard]] bool is_at2() const { return format == ".AT2"; }
  /// A single component, which may drive several axes.
  [[nodiscard]] bool has_one_component() const { return columns.size() == 1; }
};

/// Reads a file of ground motion; its content decides on the format:
/// - PEER .AT2: a header with NPTS and DT in any usual spelling, then values;
/// - K-NET, ESM and CWA: acceleration below a header of the network;
/// - CSMIP (CDMG), COSMOS and SMC: the acceleration of one channel or of several;
/// - columns separated by blanks, tabs, commas or semicolons, below any headings; the first one is
///   time, equally spaced. One column, or columns of which the first is no time, state no step.
/// @throws Error with file:line for anything else, for records of velocity or displacement, and for
///         a number of values that the file does not state   @setup
[[nodiscard]] MotionFile read_motion_file(const std::filesystem::path& file);
/// The same for the content of a file.
[[nodiscard]] MotionFile read_motion_text(const std::filesystem::path& file,
                                          std::string_view content);

/// Whether most lines are rows of numbers, or a header is that of an .AT2 file.   @setup
[[nodiscard]] bool looks_like_motion(std::string_view text);

/// Values of a column in g, converted from its unit.
/// @param column  from 1   @throws Error if there is no such column, or its unit is unknown or not
///                         one of acceleration   @setup
[[nodiscard]] std::vector<double> acceleration_in_g(const MotionFile& motion, int column);

/// Reads one column of a file of columns in its own unit.
/// @param column  index of the column to read, from 1 (0 is time)
/// @throws Error as `read_motion_file`, and for a missing column or time   @setup
[[nodiscard]] RecordComponent read_column(const std::filesystem::path& file, int column);

}  // namespace rths::sim
