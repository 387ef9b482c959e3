// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace rths::sim {

/// Column of a file from which a component was read.
struct MotionSource {
  std::filesystem::path file;
  std::string heading;  ///< of the column, or the unit of an .AT2 file; may be empty
  std::string unit;
  double per_g = 1;             ///< factor from g to this unit, from which it was converted
  bool has_one_column = false;  ///< no other one in the file
  std::size_t samples = 0;      ///< in the file
};

/// Recorded ground acceleration, equally spaced in time.
struct GroundMotion {
  double time_step = 0;                   ///< [s]
  std::vector<double> long_acceleration;  ///< [m/s²]
  std::vector<double> lat_acceleration;   ///< [m/s²], same length
  /// Upwards [m/s²], same length; empty: none. g++ needs the initializer, clang-tidy does not.
  std::vector<double> vert_acceleration = {};  // NOLINT(readability-redundant-member-init)
  /// Of the components, in this order; may be empty.
  std::vector<MotionSource> sources = {};  // NOLINT(readability-redundant-member-init)

  [[nodiscard]] double duration() const {
    return time_step * static_cast<double>(long_acceleration.size());
  }
  /// Linear between samples, zero outside the record: long, lat [m/s²].   @realtime
  [[nodiscard]] Eigen::Vector2d at(double time) const noexcept;
  /// This motion without the acceleration along axes that are not tested. @param tested  long, lat
  [[nodiscard]] GroundMotion along(const std::array<bool, 2>& tested) const;
  [[nodiscard]] double vertical_at(double time) const noexcept;  ///< as `at`, upwards [m/s²]
};

/// Reads three columns of acceleration.
/// @param columns  long, lat, vert; 0 is time   @param scale  factor on the acceleration
/// @throws Error as `read_motion_file`   @setup
[[nodiscard]] GroundMotion read_motion(const std::filesystem::path& file,
                                       const std::array<int, 3>& columns, double scale);

}  // namespace rths::sim
