// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::sim {

/// Recorded ground acceleration, equally spaced in time.
struct GroundMotion {
  double time_step = 0;                   ///< [s]
  std::vector<double> long_acceleration;  ///< [m/s²]
  std::vector<double> lat_acceleration;   ///< [m/s²], same length
  /// Upwards [m/s²], same length; empty: none. g++ needs the initializer, clang-tidy does not.
  std::vector<double> vert_acceleration = {};  // NOLINT(readability-redundant-member-init)
  /// Of the components, as in the file; may be empty.
  std::vector<std::string> headings = {};  // NOLINT(readability-redundant-member-init)

  [[nodiscard]] double duration() const {
    return time_step * static_cast<double>(long_acceleration.size());
  }
  /// Linear between samples, zero outside the record: long, lat [m/s²].   @realtime
  [[nodiscard]] Eigen::Vector2d at(double time) const noexcept;
  [[nodiscard]] double vertical_at(double time) const noexcept;  ///< as `at`, upwards [m/s²]
};

/// One component of a record.
struct RecordComponent {
  double time_step = 0;        ///< [s]
  std::vector<double> values;  ///< in the file's unit
  std::string heading;         ///< of the column, or the unit that an .AT2 file states; or empty
};

/// True for a PEER .AT2 file: by its ending, or by NPTS and DT in its fourth line.   @setup
[[nodiscard]] bool is_at2(const std::filesystem::path& file);

/// Reads a PEER .AT2 file: four header lines, the last with NPTS and DT, then values in g.
/// @throws Error with file:line   @setup
[[nodiscard]] RecordComponent read_at2(const std::filesystem::path& file);

/// Reads columns of numbers separated by blanks or commas; lines that start with '#' or a letter
/// are headings. The first column is time and must be equally spaced.
/// @param column  index of the column to read, from 1 (0 is time)
/// @throws Error with file:line for a missing column, a word that is not a number, uneven time
/// @setup
[[nodiscard]] RecordComponent read_column(const std::filesystem::path& file, int column);

/// Reads three columns of acceleration in g.
/// @param columns  long, lat, vert, as of `read_column`   @param scale  factor on the acceleration
/// @throws Error as `read_column`   @setup
[[nodiscard]] GroundMotion read_motion(const std::filesystem::path& file,
                                       const std::array<int, 3>& columns, double scale);

}  // namespace rths::sim
