// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_small(char c) { return c >= 'a' && c <= 'z'; }

struct UnitText {
  std::size_t line = 0;
  std::string_view text;  // from the unit on
};

std::size_t after_marks(std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(" \t:=([", at), text.size());
}

bool continues_unit(std::string_view rest) {
  rest = trimmed(rest);
  if (rest.empty()) return false;
  const std::string small = in_small_letters(rest.substr(0, 6));
  return has("/*^%0123456789", rest.substr(0, 1)) || small.starts_with("x ") ||
         small.starts_with("times ") || small.starts_with("per ");
}

// "ACCELERATION TIME HISTORY (G)" or "ACCELERATION IN CM/SEC2"; other titles hold other words.
std::optional<UnitText> unit_of_title(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i) {
    const std::string small = in_small_letters(text.lines[i]);
    const auto title = std::min(small.find("acc"), small.find("time "));
    if (title == std::string::npos) continue;
    for (const std::string_view before : {"(", "[", " in "}) {
      const auto at = small.find(before, title);
      if (at == std::string::npos) continue;
      const auto unit = text.lines[i].substr(after_marks(small, at + before.size()));
      const bool is_stated = states_time_history(small) || has(unit, "/");
      if (is_stated || leading_unit(unit).unit != nullptr) return UnitText{i, unit};
    }
  }
  return std::nullopt;
}

// After "UNITS OF", "UNITS:" or "UNIT", or in the title.
std::optional<UnitText> unit_text(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i) {
    const std::string small = in_small_letters(text.lines[i]);
    auto at = small.find("unit");
    if (at == std::string::npos || (at > 0 && is_small(small[at - 1]))) continue;
    at += small.compare(at, 5, "units") == 0 ? 5 : 4;
    if (at < small.size() && is_small(small[at])) continue;  // "united"
    at = after_marks(small, at);
    for (const std::string_view word : {"of ", "are ", "in ", "is "})
      if (small.compare(at, word.size(), word) == 0) at = after_marks(small, at + word.size());
    if (at < small.size()) return UnitText{i, text.lines[i].substr(at)};
  }
  return unit_of_title(text, end);
}

// A title such as "VELOCITY TIME HISTORY" or "REL. DISP. (CM)". Other lines may state peaks.
const char* quantity_of(std::string_view line) {
  const std::string small = in_small_letters(line);
  const bool is_title = states_time_history(small) || has(small, "unit") ||
                        small.find_first_of("0123456789") == std::string::npos;
  const char* quantity = nullptr;
  bool is_first = true;
  for (std::size_t at = 0, end = 0; at < small.size(); at = end) {
    end = at;
    while (end < small.size() && is_small(small[end])) ++end;
    const std::string_view word = std::string_view{small}.substr(at, end - at);
    end = std::max(end, at + 1);
    if (word.empty()) continue;
    const bool counts = is_title || std::exchange(is_first, false);
    if (counts && word.starts_with("acc")) return nullptr;
    if (counts && (word == "vel" || word == "veloc" || word == "velocity")) quantity = "velocity";
    if (counts && (word == "disp" || word == "displ" || word == "displacement"))
      quantity = "displacement";
  }
  return quantity;
}

// A unit that no other word looks like, anywhere in the header: "EL CENTRO, CM/SEC2".
std::optional<UnitText> unit_anywhere(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i) {
    const auto stated = stated_unit(text.lines[i]);
    if (stated.unit == nullptr || stated.unit->kind != MotionUnit::Kind::Acceleration) continue;
    if (stated.unit->per_g == 1 || stated.unit->per_g == 1000) continue;  // "G", "MG": any name
    const std::string small = in_small_letters(text.lines[i]);
    if (has(small, "max") || has(small, "peak") || has(small, "pga"))
      text.fail(i, fmt::format("'{}' states the unit of the peak, expected that of the values, as "
                               "in 'UNITS OF G'",
                               trimmed(text.lines[i])));
    return UnitText{i, stated.unit->name};
  }
  return std::nullopt;
}

void reject_other_unit(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i)
    if (mentions_other_acceleration(text.lines[i]))
      text.fail(i, fmt::format("'{}' mentions a unit, expected that of the values as in 'UNITS OF "
                               "CM/SEC2'",
                               trimmed(text.lines[i].substr(0, 100))));
}

}  // namespace

StatedUnit leading_unit(std::string_view text) {
  constexpr std::string_view kMarks = " \t,;:()]";
  StatedUnit found;
  for (std::size_t end = 1; end <= std::min<std::size_t>(text.size(), 24); ++end) {
    const bool ends_sentence = text[end - 1] == '.';
    if (end < text.size() && !has(kMarks, text.substr(end, 1)) && text[end] != '.') continue;
    const auto* unit = ends_sentence ? nullptr : find_unit(trimmed(text.substr(0, end)));
    if (unit != nullptr) found.unit = continues_unit(text.substr(end)) ? nullptr : unit;
  }
  if (found.unit == nullptr) found.unknown = trimmed(text.substr(0, text.find_first_of(",;:)]")));
  return found;
}

void read_at2_unit(const MotionText& text, std::size_t end, MotionColumn& column) {
  for (std::size_t i = 0; i < end; ++i)
    if (const char* quantity = quantity_of(text.lines[i]))
      text.fail(i, fmt::format("'{}': a record of {}, expected acceleration",
                               trimmed(text.lines[i]), quantity));
  auto found = unit_text(text, end);
  if (!found) found = unit_anywhere(text, end);
  if (!found) return reject_other_unit(text, end);
  column.stated = leading_unit(found->text);
  column.heading = trimmed(found->text);
  const auto* unit = column.stated.unit;
  if (unit == nullptr)
    text.fail(found->line,
              fmt::format("the unit '{}' is unknown, expected G, CM/SEC2, GAL or M/SEC2",
                          column.stated.unknown));
  if (unit->kind != MotionUnit::Kind::Acceleration)
    text.fail(found->line, fmt::format("the unit is {}, expected one of acceleration", unit->name));
}

}  // namespace rths::sim
