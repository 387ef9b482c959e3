// SPDX-License-Identifier: Apache-2.0
//
// Records of CSMIP (formerly CDMG) and COSMOS. Each channel has a header, and one block of values
// per quantity below a line such as
//   3251 points of accel data equally spaced at  .020 sec, in cm/sec2. (8f10.3)
//   13200 Accelerogram points at 200 pts/sec in units of g .      Format: (8f9.6)
//   7000  acceleration pts, approx   70 secs, units=cm/sec2(04),Format=(8F10.5)
// Uncorrected records of CDMG have pairs of time and acceleration, and no such line.
#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

constexpr double kMostPoints = 1e9;

bool states(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

// The number behind a word, such as 13200 of "no. of points =  13200".
std::optional<double> number_behind(std::string_view text, std::string_view word) {
  const auto at = text.find(word);
  if (at == text.npos) return std::nullopt;
  text.remove_prefix(at + word.size());
  text.remove_prefix(std::min(text.find_first_not_of(" =:"), text.size()));
  double number = 0;
  return take_number(text, number, {}) ? std::optional{number} : std::nullopt;
}

/// The line above a block of values.
struct BlockLine {
  std::size_t line = 0, count = 0;
  bool is_acceleration = false;
  std::optional<double> step, duration;  // [s]
  std::string unit;                      // as written, and the text behind it
  ValueFormat format;
};

std::string unit_behind(std::string_view small) {
  for (const std::string_view word :
       {"units of ", "in units ", "units=", "units:", "units =", " in "})
    if (const auto at = small.find(word); at != small.npos)
      return std::string{trimmed(small.substr(at + word.size()))};
  return "";
}

std::optional<std::size_t> count_at_start(std::string_view text) {
  double count = 0;
  text = trimmed(text);
  if (!take_number(text, count, {}) || !(count >= 1 && count < kMostPoints)) return std::nullopt;
  return count == std::floor(count) ? std::optional{static_cast<std::size_t>(count)} : std::nullopt;
}

std::optional<BlockLine> block_line(const MotionText& text, std::size_t line) {
  const auto count = count_at_start(text.lines[line].substr(0, 16));
  if (!count) return std::nullopt;
  const std::string small = in_small_letters(text.lines[line]);
  BlockLine block{line, *count, states(small, "acc"), {}, {}, "", {}};
  block.step = number_behind(small, "equally spaced at ");
  if (const auto rate = number_behind(small, "points at "); rate && *rate > 0)
    block.step = 1 / *rate;
  block.duration = number_behind(small, "pts, approx ");
  if (!block.step && !block.duration) return std::nullopt;
  block.unit = unit_behind(small);
  block.format = stated_format(text.lines[line]);
  return block;
}

bool has_block_line(const MotionText& text) {
  for (std::size_t i = 0; i < text.lines.size(); ++i)
    if (block_line(text, i)) return true;
  return false;
}

// "Chan  1: 360 Deg (Rcrdr Chan  1)" is "Chan 1: 360 Deg".
std::string channel_name(const MotionText& text, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    const auto line = trimmed(text.lines[i]);
    const std::string small = in_small_letters(line);
    if (!small.starts_with("chan") && !small.starts_with("sta cha") && !small.starts_with("comp "))
      continue;
    std::string name;
    for (const auto word : cells_of(line.substr(0, line.find('(')), ' ')) {
      if (in_small_letters(word).starts_with("location")) break;
      name += (name.empty() ? "" : " ") + std::string{word};
    }
    return name;
  }
  return "";
}

// COSMOS: the 62nd number of the header of reals [ms].
double step_of_reals(const MotionText& text, std::size_t begin, const BlockLine& block) {
  constexpr std::size_t kReals = 100, kStep = 61;
  constexpr double kMilli = 1e-3;
  for (std::size_t i = begin; i < block.line; ++i) {
    if (!states(in_small_letters(text.lines[i]), "real-header values follow")) continue;
    std::size_t first = i + 1;
    const auto reals = read_values(text, first, kReals, stated_format(text.lines[i]));
    const double step = kMilli * reals[kStep];
    const double most = std::max(1.0, 0.02 * *block.duration);  // [s], of the rounded duration
    if (step > 0 && std::abs(step * static_cast<double>(block.count) - *block.duration) <= most)
      return step;
    text.fail(first - 1,
              fmt::format("the time step is {:g} ms for {} values, expected {:g} s in total",
                          reals[kStep], block.count, *block.duration));
  }
  text.fail(block.line, "no 'Real-header values' found above, expected the time step there");
}

StatedUnit unit_of_block(const MotionText& text, std::size_t begin, const BlockLine& block) {
  std::string unit = block.unit;
  // USC: "Peak acceleration = -6.869 cms/sec/sec at .640 sec."
  for (std::size_t i = begin; unit.empty() && i < block.line; ++i) {
    const std::string small = in_small_letters(text.lines[i]);
    if (const auto at = small.find("peak acceleration"); at != small.npos)
      if (const auto from = small.find("cm", at); from != small.npos)
        unit = small.substr(from, small.find(" at ") - from);
  }
  const StatedUnit stated = leading_unit(unit);
  if (stated.unit == nullptr)
    text.fail(block.line,
              fmt::format("the unit '{}' is unknown, expected g, g/10 or cm/sec2", stated.unknown));
  return stated;
}

// A further row would be lost.
void check_end(const MotionText& text, std::size_t line, std::size_t count) {
  while (line < text.lines.size() && trimmed(text.lines[line]).empty()) ++line;
  if (line < text.lines.size() && is_row(text.lines[line], {.fortran = true}))
    text.fail(line, fmt::format("more values found, expected {}", count));
}

void set_step(const MotionText& text, std::size_t line, double step, MotionFile& motion) {
  if (!(step > 0 && step <= 1))
    text.fail(line, fmt::format("the time step is {:g} s, expected at most 1 s", step));
  if (motion.time_step != 0 && std::abs(motion.time_step - step) > 1e-6 * step)
    text.fail(line, fmt::format("the time step is {:g} s, and {:g} s of the channel above", step,
                                motion.time_step));
  motion.time_step = step;
}

MotionFile read_blocks(const MotionText& text) {
  MotionFile motion{text.file, "CSMIP", 0, {}};
  motion.has_channels = true;
  bool has_other = false;
  for (std::size_t line = 0, begin = 0; line < text.lines.size();) {
    const auto block = block_line(text, line);
    if (!block) {
      ++line;
      continue;
    }
    std::size_t at = line + 1;
    auto values = read_values(text, at, block->count, block->format);
    check_end(text, at, block->count);
    if (block->is_acceleration) {
      if (block->duration) motion.format = "COSMOS";
      const double step = block->step ? *block->step : step_of_reals(text, begin, *block);
      set_step(text, line, step, motion);
      motion.columns.push_back(
          {channel_name(text, begin, line), unit_of_block(text, begin, *block), std::move(values)});
    }
    has_other = has_other || !block->is_acceleration;
    line = begin = at;
  }
  if (motion.columns.empty())
    text.fail(0, has_other
                     ? "a record of velocity or displacement, expected acceleration"
                     : "no values found below a line such as '3251 points of accel data equally "
                       "spaced at .020 sec, in cm/sec2'");
  return motion;
}

/// Lines of an uncorrected record of CDMG: 13 of text, 7 of integers and 7 of reals.
constexpr std::size_t kTextLines = 13, kHeaderLines = 27;

bool begins_pairs(const MotionText& text, std::size_t line) {
  return line + kHeaderLines < text.lines.size() &&
         states(in_small_letters(text.lines[line]), "uncorrected accelerogram data");
}

struct PairHeader {
  std::size_t count = 0;
  StatedUnit unit;
};

// "NO. OF POINTS = 12080 RECORD LENGTH = 59.998 SEC", "UNITS OF UNCOR ACCEL ARE SEC AND G/10."
PairHeader pair_header(const MotionText& text, std::size_t begin) {
  PairHeader header;
  for (std::size_t i = begin; i < begin + kTextLines; ++i) {
    const std::string small = in_small_letters(text.lines[i]);
    const auto points = number_behind(small, "no. of points");
    if (points && *points >= 2 && *points < kMostPoints)
      header.count = static_cast<std::size_t>(*points);
    const auto at = small.find("sec and ");
    if (!small.starts_with("units ") || at == small.npos) continue;
    const auto unit = std::string_view{small}.substr(at + 8);
    header.unit = leading_unit(unit.substr(0, unit.find("  ")));
  }
  if (header.count == 0) text.fail(begin, "the header states no 'No. of points'");
  if (header.unit.unit == nullptr)
    text.fail(begin, "the header states no known unit, expected 'units are sec and g/10' or alike");
  return header;
}

// Film is digitised at any instant; digital recorders sample at equal steps.
MotionFile read_pairs(const MotionText& text) {
  constexpr ValueFormat kFormat{10, 7};
  MotionFile motion{text.file, "CSMIP", 0, {}};
  motion.has_channels = true;
  for (std::size_t line = 0; line < text.lines.size(); ++line) {
    if (!begins_pairs(text, line)) continue;
    const auto header = pair_header(text, line);
    std::size_t at = line + kHeaderLines;
    const auto numbers = read_values(text, at, 2 * header.count, kFormat);
    check_end(text, at, header.count);
    std::vector<double> stamps, values;
    for (std::size_t i = 0; i < numbers.size(); i += 2) {
      stamps.push_back(numbers[i]);
      values.push_back(numbers[i + 1]);
    }
    const auto steps = time_steps(stamps);
    if (steps.wrong)
      text.fail(line + kHeaderLines + *steps.wrong / (kFormat.per_line / 2),
                "time is not equally spaced, expected the corrected record (volume 2)");
    set_step(text, line, steps.step, motion);
    motion.columns.push_back(
        {channel_name(text, line, line + kTextLines), header.unit, std::move(values)});
    line = at - 1;
  }
  return motion;
}

}  // namespace

bool has_channel_blocks(const MotionText& text) {
  if (text.lines.empty()) return false;
  const std::string small = in_small_letters(trimmed(text.lines[0]));
  if (small.starts_with("corrected acc") || small.starts_with("uncorrected acc") ||
      states(small, "uncorrected accelerogram data") || states(small, "(format v"))
    return true;
  return states(small, "accelerogram") && has_block_line(text);
}

MotionFile read_channel_blocks(const MotionText& text) {
  bool has_pairs = false;
  for (std::size_t i = 0; i < text.lines.size(); ++i)
    has_pairs = has_pairs || begins_pairs(text, i);
  return has_pairs && !has_block_line(text) ? read_pairs(text) : read_blocks(text);
}

}  // namespace rths::sim
