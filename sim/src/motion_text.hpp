// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rths/sim/motion_file.hpp>

namespace rths::sim {

/// Lines of a file of ground motion.
struct MotionText {
  std::filesystem::path file;
  std::vector<std::string_view> lines;

  /// @param line  index, from 0   @throws Error "file:line: problem", lines from 1
  [[noreturn]] void fail(std::size_t line, const std::string& problem) const;
};

/// How numbers are written.
struct NumberStyle {
  /// By a program in Fortran: a sign may separate them, "2.91E-03-5.62E-04", and an exponent may
  /// have no letter, ".291-03".
  bool fortran = false;
};

/// Takes a number from the start of a text: "2.91E-03", "+.5" or "5.0D-03".
/// @returns false, with the text unchanged: it starts with no finite number
[[nodiscard]] bool take_number(std::string_view& text, double& number, NumberStyle style);

/// Adds the numbers of a line to `numbers`.
/// @returns the first word that is no number; empty: there is none
[[nodiscard]] std::string_view add_numbers(std::string_view line, NumberStyle style,
                                           std::vector<double>& numbers);

/// Whether all words of a line are numbers, and there is one.
[[nodiscard]] bool is_row(std::string_view line, NumberStyle style);

/// Columns of a fixed width, as "(8F10.5)" states them.
struct ValueFormat {
  std::size_t per_line = 0, width = 0;  ///< 0: not stated
};

/// The format that the last parenthesis of a line states.
[[nodiscard]] ValueFormat stated_format(std::string_view line);

/// Reads `count` values; they may touch if a format is stated. Blank lines have none.
/// @param line  in: the first; out: behind the last   @throws Error for another number of values
[[nodiscard]] std::vector<double> read_values(const MotionText& text, std::size_t& line,
                                              std::size_t count, ValueFormat format);

/// Time step of stamps that are equally spaced within the rounding of their printed digits.
/// @returns the step [s], and the first stamp that is off; none: all are in place
struct TimeSteps {
  double step = 0;
  std::optional<std::size_t> wrong;
};
[[nodiscard]] TimeSteps time_steps(const std::vector<double>& stamps);

/// Whether a title, in small letters, is that of a record.
[[nodiscard]] bool states_time_history(std::string_view small);

/// The longest start of a text that is a known unit: "CM / SEC2, FILTERED".
[[nodiscard]] StatedUnit leading_unit(std::string_view text);

/// Whether a line mentions a unit of acceleration other than g, such as "{m/s2}" or "a_mps2". Units
/// at places that are not understood must not be lost: the values are not in g.
[[nodiscard]] bool mentions_other_acceleration(std::string_view line);

/// Whether a line of the header names NPTS, or states that a time history follows.
[[nodiscard]] bool has_at2_header(const MotionText& text);

/// @throws Error for a header that is not understood, and for values beside its number
[[nodiscard]] MotionFile read_at2(const MotionText& text);
[[nodiscard]] MotionFile read_columns(const MotionText& text);

/// A record of K-NET or KiK-net: counts, of which the mean is the offset.
[[nodiscard]] bool has_k_net_header(const MotionText& text);
/// @throws Error for a damaged header, and for a number of values or a peak beside those stated
[[nodiscard]] MotionFile read_k_net(const MotionText& text);

/// A record of CSMIP (CDMG) or COSMOS, of any volume: blocks of values of one or more channels.
[[nodiscard]] bool has_channel_blocks(const MotionText& text);
/// @throws Error for a damaged header, another number of values, and records without acceleration
[[nodiscard]] MotionFile read_channel_blocks(const MotionText& text);

/// A record of USGS in its format SMC.
[[nodiscard]] bool has_smc_header(const MotionText& text);
/// @throws Error as `read_channel_blocks`, and for stamps that are not equally spaced
[[nodiscard]] MotionFile read_smc(const MotionText& text);

/// A record of the Central Weather Administration of Taiwan: time, and three components in gal.
[[nodiscard]] bool has_cwa_header(const MotionText& text);
/// @throws Error as `read_k_net`
[[nodiscard]] MotionFile read_cwa(const MotionText& text);

/// A record of the Engineering Strong-Motion database.
[[nodiscard]] bool has_esm_header(const MotionText& text);
/// @throws Error as `read_k_net`, and for velocity and displacement
[[nodiscard]] MotionFile read_esm(const MotionText& text);

}  // namespace rths::sim
