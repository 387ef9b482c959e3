// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/motion_file.hpp>

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

/// Two texts that only the header of a format has.
struct Foreign {
  const char* name;
  std::string_view one, other;
};
constexpr Foreign kForeign[] = {{"a COSMOS", "(Format v", "text lines)"},
                                {"a CSMIP", "ccelerogram", "points of accel data"},
                                {"a CSMIP", "CCELEROGRAM", "POINTS OF ACCEL DATA"},
                                {"an SMC", "CORRECTED ACCELEROGRAM", "\n*"}};

// Values of these records are integers, or have another unit.
void reject_foreign(const std::filesystem::path& file, std::string_view text) {
  constexpr std::size_t kHeader = 4096;  // [B]
  const auto header = text.substr(0, kHeader);
  for (const Foreign& one : kForeign)
    if (header.find(one.one) != header.npos && header.find(one.other) != header.npos)
      throw Error{fmt::format("{}: looks like {} record, expected .AT2, or columns with time first",
                              file.string(), one.name)};
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
  if (content.find('\0') != content.npos)
    throw Error{fmt::format("{}: found bytes that are zero, expected text", file.string())};
  reject_foreign(file, content);
  const MotionText text{file, lines_of(without_end_mark(content))};
  if (has_k_net_header(text)) return read_k_net(text);
  if (has_esm_header(text)) return read_esm(text);
  return has_at2_header(text) ? read_at2(text) : read_columns(text);
}

bool looks_like_motion(std::string_view text) {
  const MotionText lines{{}, lines_of(text)};
  const auto rows = std::count_if(lines.lines.begin(), lines.lines.end(), [](auto line) {
    return is_row(line, {}) || is_row(line, {.decimal_comma = true});
  });
  const auto filled = std::count_if(lines.lines.begin(), lines.lines.end(),
                                    [](auto line) { return !trimmed(line).empty(); });
  if (has_k_net_header(lines) || has_esm_header(lines)) return true;
  return 2 * rows > filled || (rows > 0 && has_at2_header(lines));
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
