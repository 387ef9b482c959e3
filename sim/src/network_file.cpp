// SPDX-License-Identifier: Apache-2.0
//
// Records as networks of stations publish them.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/maths/statistics.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

struct Field {
  std::size_t line = 0;
  std::string_view text;  // after the key
};

std::optional<Field> find_field(const MotionText& text, std::string_view key) {
  constexpr std::size_t kMostHeaderLines = 100;
  for (std::size_t i = 0; i < std::min(text.lines.size(), kMostHeaderLines); ++i)
    if (text.lines[i].starts_with(key)) return Field{i, trimmed(text.lines[i].substr(key.size()))};
  return std::nullopt;
}

Field field_of(const MotionText& text, std::string_view key) {
  const auto field = find_field(text, key);
  if (!field) text.fail(0, fmt::format("'{}' not found in the header", key));
  return *field;
}

// The number at the start of a field, such as 100 of "100Hz".
double number_of_field(const MotionText& text, std::string_view key) {
  Field field = field_of(text, key);
  double number = 0;
  if (!take_number(field.text, number, {}) || !(number > 0))
    text.fail(field.line,
              fmt::format("'{}', expected a positive number", trimmed(text.lines[field.line])));
  return number;
}

std::vector<double> values_from(const MotionText& text, std::size_t line, double count,
                                std::string_view origin) {
  std::vector<double> values;
  for (; line < text.lines.size(); ++line)
    if (const auto word = add_numbers(text.lines[line], {}, values); !word.empty())
      text.fail(line, fmt::format("'{}' is not a number", word.substr(0, 40)));
  if (std::abs(static_cast<double>(values.size()) - count) > 0.5 || values.size() < 2)
    text.fail(text.lines.size() - 1,
              fmt::format("{} values found, expected {:g} ({})", values.size(), count, origin));
  return values;
}

// "3920(gal)/6182761"
double scale_factor(const MotionText& text) {
  Field field = field_of(text, "Scale Factor");
  constexpr std::string_view kGalPer = "(gal)/";
  double gal = 0, counts = 0;
  if (take_number(field.text, gal, {}) && field.text.starts_with(kGalPer)) {
    field.text.remove_prefix(kGalPer.size());
    if (take_number(field.text, counts, {}) && gal > 0 && counts > 0) return gal / counts;
  }
  text.fail(field.line, fmt::format("'{}', expected a scale factor such as 3920(gal)/6182761",
                                    trimmed(text.lines[field.line])));
}

}  // namespace

bool has_k_net_header(const MotionText& text) {
  return find_field(text, "Origin Time") && find_field(text, "Scale Factor");
}

bool has_esm_header(const MotionText& text) {
  return find_field(text, "EVENT_NAME:") && find_field(text, "SAMPLING_INTERVAL_S:");
}

MotionFile read_k_net(const MotionText& text) {
  constexpr double kPeakTolerance = 0.02;  // of the stated peak: an offset of another window
  const double rate = number_of_field(text, "Sampling Freq(Hz)");
  const double duration = number_of_field(text, "Duration Time(s)"), scale = scale_factor(text);
  MotionColumn column{std::string{field_of(text, "Dir.").text}, {find_unit("gal"), ""}, {}};
  column.values =
      values_from(text, field_of(text, "Memo.").line + 1, duration * rate, "Duration Time");
  const double offset = std::accumulate(column.values.begin(), column.values.end(), 0.0) /
                        static_cast<double>(column.values.size());
  for (double& value : column.values) value = scale * (value - offset);
  const double stated = number_of_field(text, "Max. Acc. (gal)");
  const double peak = maths::largest_magnitude(column.values);
  if (std::abs(peak - stated) > kPeakTolerance * stated)
    text.fail(field_of(text, "Max. Acc. (gal)").line,
              fmt::format("the peak is {:g} gal, expected {:g} gal", peak, stated));
  return {text.file, "K-NET", 1 / rate, {std::move(column)}};
}

bool has_cwa_header(const MotionText& text) {
  return find_field(text, "#StationCode:") && find_field(text, "#AmplitudeUnit:") &&
         find_field(text, "#DataSequence:");
}

// "#DataSequence: Time U(+); N(+); E(+)"
MotionFile read_cwa(const MotionText& text) {
  MotionFile motion{text.file, "CWA", 1 / number_of_field(text, "#SampleRate(Hz):"), {}};
  motion.has_channels = true;
  const Field sequence = field_of(text, "#DataSequence:"), unit = field_of(text, "#AmplitudeUnit:");
  std::string_view names = sequence.text;
  const StatedUnit stated = leading_unit(unit.text);
  if (stated.unit == nullptr)
    text.fail(unit.line, fmt::format("the unit '{}' is unknown, expected gal", stated.unknown));
  if (!names.starts_with("Time "))
    text.fail(sequence.line, fmt::format("'{}', expected Time first", names));
  for (const auto name : cells_of(names.substr(5), ';')) {
    if (!name.ends_with("(+)"))
      text.fail(sequence.line, fmt::format("'{}', expected a component such as N(+)", name));
    motion.columns.push_back({std::string{name.substr(0, name.size() - 3)}, stated, {}});
  }
  const std::size_t width = motion.columns.size() + 1;
  const double rows = number_of_field(text, "#RecordLength(sec):") / motion.time_step;
  const auto numbers = values_from(text, field_of(text, "#Data:").line + 1,
                                   std::round(rows) * static_cast<double>(width), "#RecordLength");
  std::vector<double> stamps;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    (i % width == 0 ? stamps : motion.columns[i % width - 1].values).push_back(numbers[i]);
  const auto steps = time_steps(stamps);
  if (steps.wrong || std::abs(steps.step - motion.time_step) > 1e-3 * motion.time_step)
    text.fail(field_of(text, "#SampleRate(Hz):").line,
              "the times of the rows are not those of the sample rate");
  return motion;
}

MotionFile read_esm(const MotionText& text) {
  const Field type = field_of(text, "DATA_TYPE:"), unit = field_of(text, "UNITS:");
  if (!in_small_letters(type.text).ends_with("acceleration"))
    text.fail(type.line, fmt::format("a record of {}, expected ACCELERATION", type.text));
  MotionColumn column{"", {find_unit(unit.text), ""}, {}};
  if (column.stated.unit == nullptr || column.stated.unit->kind != MotionUnit::Kind::Acceleration)
    text.fail(unit.line, fmt::format("the unit is '{}', expected cm/s^2", unit.text));
  if (const auto stream = find_field(text, "STREAM:")) column.heading = stream->text;
  std::size_t first = unit.line;
  while (first < text.lines.size() && !is_row(text.lines[first], {})) ++first;
  column.values = values_from(text, first, number_of_field(text, "NDATA:"), "NDATA");
  return {text.file, "ESM", number_of_field(text, "SAMPLING_INTERVAL_S:"), {std::move(column)}};
}

}  // namespace rths::sim
