// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/motion_file.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

/// A format that its header shows, unlike columns.
struct Format {
  bool (*is_of)(const MotionText&);
  MotionFile (*read)(const MotionText&);
};
constexpr Format kFormats[] = {
    {has_k_net_header, read_k_net}, {has_esm_header, read_esm},
    {has_cwa_header, read_cwa},     {has_smc_header, read_smc},
    {has_at2_header, read_at2},     {has_channel_blocks, read_channel_blocks}};

const Format* format_of(const MotionText& text) {
  const auto found = std::find_if(std::begin(kFormats), std::end(kFormats),
                                  [&](const Format& format) { return format.is_of(text); });
  return found == std::end(kFormats) ? nullptr : found;
}

std::string_view without_end_mark(std::string_view text) {
  while (text.ends_with('\x1A')) text.remove_suffix(1);  // of DOS
  return text;
}

const MotionColumn& column_of(const MotionFile& motion, int column) {
  if (column >= 1 && static_cast<std::size_t>(column) <= motion.columns.size())
    return motion.columns[static_cast<std::size_t>(column - 1)];
  throw Error{fmt::format("{}:{}: {} columns found, expected column {} (0 is time)",
                          motion.file.string(), motion.first_line, motion.columns.size() + 1,
                          column)};
}

}  // namespace

MotionFile read_motion_file(const std::filesystem::path& file) {
  return read_motion_text(file, read_text(file));
}

MotionFile read_motion_text(const std::filesystem::path& file, std::string_view content) {
  const std::string points = with_decimal_points(std::string{without_end_mark(content)});
  const MotionText text{file, lines_of(points)};
  const Format* format = format_of(text);
  return format == nullptr ? read_columns(text) : format->read(text);
}

bool looks_like_motion(std::string_view text) {
  const std::string points = with_decimal_points(std::string{text});
  const MotionText lines{{}, lines_of(points)};
  const auto rows = std::ranges::count_if(lines.lines, [](auto line) { return is_row(line, {}); });
  const auto filled =
      std::ranges::count_if(lines.lines, [](auto line) { return !trimmed(line).empty(); });
  return 2 * rows > filled || (rows > 0 && format_of(lines) != nullptr);
}

std::vector<double> acceleration_in_g(const MotionFile& motion, int column) {
  const std::string place = motion.file.string();
  const MotionColumn& found = column_of(motion, column);
  if (!found.stated.unknown.empty())
    throw Error{
        fmt::format("{}: the unit '{}' of the column '{}' is unknown, expected g, m/s², "
                    "gal or mm/s²",
                    place, found.stated.unknown, found.heading)};
  const MotionUnit& unit = found.stated.unit == nullptr ? kUnitG : *found.stated.unit;
  if (unit.kind != MotionUnit::Kind::Acceleration)
    throw Error{
        fmt::format("{}: the column '{}' is no acceleration ({}), expected a column in g: "
                    "another column_long or column_lat?",
                    place, found.heading, unit.name)};
  std::vector<double> values = found.values;
  for (double& value : values) value /= unit.per_g;
  return values;
}

RecordComponent read_column(const std::filesystem::path& file, int column) {
  const MotionFile motion = read_motion_file(file);
  if (motion.format != "columns")
    throw Error{
        fmt::format("{}: found a record of ground acceleration ({}), expected columns with "
                    "time first",
                    file.string(), motion.format)};
  if (motion.time_step == 0)
    throw Error{file.string() + ": no column of time, expected time as the first column"};
  const auto& found = column_of(motion, column);
  return {motion.time_step, found.values, found.heading};
}

}  // namespace rths::sim
