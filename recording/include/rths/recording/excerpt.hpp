// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/recording/recording.hpp>

namespace rths::recording {

/// Signals of a recording between two times, as a table with one row per time.
struct Excerpt {
  std::vector<double> time;  ///< since the run began [s]
  std::vector<std::string> names, units;
  std::vector<std::vector<double>> values;  ///< one column per name [SI]
};

/// @param from  first time, included [s]   @param to  last time, included [s]
/// @throws Error if the recording lacks a signal, or has no row between the times   @setup
[[nodiscard]] Excerpt make_excerpt(const Reader& reader, const std::vector<std::string>& names,
                                   double from, double to);

/// Writes CSV: a header "time [s],name [unit],…", then nine significant digits, NaN for missing
/// values. Replaces the file as a whole. @throws Error if it cannot be written   @setup
void write_csv(const Excerpt& excerpt, const std::filesystem::path& file);

/// Writes a MAT file, version 5: time (rows × 1), values (rows × signals), names and units (cells).
/// Replaces the file as a whole.
/// @throws Error if it cannot be written, or is larger than the format allows   @setup
void write_mat(const Excerpt& excerpt, const std::filesystem::path& file);

}  // namespace rths::recording
