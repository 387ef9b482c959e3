// SPDX-License-Identifier: Apache-2.0
//
// Records of USGS in its format SMC: 11 lines of text, 48 integers, 50 reals, comments, values in
// cm/s². The first integer and the first real stand for a missing number.

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

constexpr std::size_t kTextLines = 11, kTitleLine = 5;
constexpr std::size_t kIntegers = 48, kComments = 15, kPoints = 16;
constexpr std::size_t kReals = 50, kRate = 1;
constexpr ValueFormat kIntegerFormat{8, 10}, kRealFormat{5, 15}, kValueFormat{8, 10};

// "station = San Francisco, 1295 Shafter component=   up"
std::string component_of(std::string_view title) {
  const auto at = in_small_letters(title).find("component=");
  return at == std::string::npos ? "" : std::string{trimmed(title.substr(at + 10))};
}

}  // namespace

bool has_smc_header(const MotionText& text) {
  if (text.lines.size() < kTextLines || !trimmed(text.lines[1]).starts_with('*')) return false;
  const std::string small = in_small_letters(text.lines[0]);
  for (const char* word : {"accelerogram", "velocity", "displacement", "spectr"})
    if (small.find(word) != small.npos) return true;
  return trimmed(text.lines[0]).starts_with('*') && trimmed(text.lines[10]).starts_with('*');
}

MotionFile read_smc(const MotionText& text) {
  if (in_small_letters(text.lines[0]).find("accelerogram") == std::string::npos)
    text.fail(0, fmt::format("'{}': an SMC record, expected one of an accelerogram",
                             trimmed(text.lines[0])));
  std::size_t line = kTextLines;
  const auto integers = read_values(text, line, kIntegers, kIntegerFormat);
  const auto reals = read_values(text, line, kReals, kRealFormat);
  const double missing = reals[0], rate = reals[kRate], points = integers[kPoints];
  if (rate == missing)
    text.fail(line,
              "an SMC record with a time for each value, expected the corrected record "
              "(volume 2)");
  if (!(rate >= 1 && rate <= 1e5) || !(points >= 2 && points < 1e9))
    text.fail(kTextLines, fmt::format("an SMC record of {:g} values at {:g} Hz, expected two or "
                                      "more at 1 Hz or more",
                                      points, rate));
  const double comments = integers[kComments];
  for (double i = 0; i < comments; ++i, ++line)
    if (line >= text.lines.size() || !trimmed(text.lines[line]).starts_with('|'))
      text.fail(line, fmt::format("expected {:g} lines of comment that begin with '|'", comments));
  MotionColumn column{component_of(text.lines[kTitleLine]), {find_unit("cm/s2"), ""}, {}};
  column.values = read_values(text, line, static_cast<std::size_t>(points), kValueFormat);
  for (; line < text.lines.size(); ++line)
    if (!trimmed(text.lines[line]).empty())
      text.fail(line, fmt::format("further values, expected {:g}", points));
  return {text.file, "SMC", 1 / rate, {std::move(column)}};
}

}  // namespace rths::sim
