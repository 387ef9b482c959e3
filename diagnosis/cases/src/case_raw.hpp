// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <rths/cases/case.hpp>

#include "case_source.hpp"

namespace rths::diagnosis {

inline constexpr double kPrintedTime = 1e-6;  ///< resolution of printed time stamps [s]
inline constexpr double kLowestRate = 1e-6, kHighestRate = 1e9;  ///< sampling rate [Hz]

inline constexpr const char* kNoTime = "none";  ///< as the time of rows without time

/// Contents of a record's file, before cutting and resampling.
struct Raw {
  std::string file;
  bool has_time = true;
  std::vector<double> time;  ///< [s]; without time the numbers of the rows, from 1 on
  std::vector<Channel> channels;
  Trouble time_trouble;                                   ///< of `time`
  std::vector<Trouble> troubles;                          ///< of each channel
  std::vector<std::pair<std::size_t, double>> constants;  ///< channel, its value [SI]
  std::vector<std::pair<std::size_t, std::size_t>> gaps;  ///< as in Record, of resampled data
};

/// Samples of the longest gap whose interpolated values are compared as if they were recorded.
inline constexpr std::size_t kBridged = 5;

/// Reads the channels that a record names.
/// @throws Error with the position of a channel that cannot be read   @setup
[[nodiscard]] Raw read_raw(const Config& channels, Files& files, const std::string& file);

/// Keeps the samples from `from` to `to` [s], both included.
/// @throws Error, without a position, if fewer than two samples remain   @setup
void cut_out(Raw& raw, double from, double to);

/// @throws Error if a time stamp is not after the one before it   @setup
void require_increase(const Raw& raw, std::size_t row);

/// The usual distance of two time stamps [s].
[[nodiscard]] double median_step(const std::vector<double>& time);

/// Resamples at equal spacing by linear interpolation. Notes gaps of more than five samples.
/// @param rate  [Hz]   @throws Error if time does not increase   @setup
void resample(Raw& raw, double rate);

}  // namespace rths::diagnosis
