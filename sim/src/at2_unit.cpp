// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

bool has(std::string_view text, std::string_view part) {
  return text.find(part) != std::string_view::npos;
}

bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

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
  const std::string capitals = in_capitals(rest.substr(0, 6));
  return has("/*^%0123456789", rest.substr(0, 1)) || capitals.starts_with("X ") ||
         capitals.starts_with("TIMES ") || capitals.starts_with("PER ");
}

// The longest start of a text, up to a mark or blank, that is a known unit: "CM / SEC2, FILTER".
StatedUnit leading_unit(std::string_view text) {
  constexpr std::string_view kMarks = " \t,;:)]";
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

// "ACCELERATION TIME HISTORY (G)" or "ACCELERATION IN CM/SEC2"; other titles hold other words.
std::optional<UnitText> unit_of_title(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i) {
    const std::string capitals = in_capitals(text.lines[i]);
    const auto title = std::min(capitals.find("ACCEL"), capitals.find("TIME "));
    if (title == std::string::npos) continue;
    for (const std::string_view before : {"(", "[", " IN "}) {
      const auto at = capitals.find(before, title);
      if (at == std::string::npos) continue;
      const auto unit = text.lines[i].substr(after_marks(capitals, at + before.size()));
      const bool is_stated = states_time_history(capitals) || has(unit, "/");
      if (is_stated || leading_unit(unit).unit != nullptr) return UnitText{i, unit};
    }
  }
  return std::nullopt;
}

// After "UNITS OF", "UNITS:" or "UNIT", or in the title.
std::optional<UnitText> unit_text(const MotionText& text, std::size_t end) {
  for (std::size_t i = 0; i < end; ++i) {
    const std::string capitals = in_capitals(text.lines[i]);
    auto at = capitals.find("UNIT");
    if (at == std::string::npos || (at > 0 && is_capital(capitals[at - 1]))) continue;
    at += capitals.compare(at, 5, "UNITS") == 0 ? 5 : 4;
    if (at < capitals.size() && is_capital(capitals[at])) continue;  // "UNITED"
    at = after_marks(capitals, at);
    for (const std::string_view word : {"OF ", "ARE ", "IN ", "IS "})
      if (capitals.compare(at, word.size(), word) == 0)
        at = after_marks(capitals, at + word.size());
    if (at < capitals.size()) return UnitText{i, text.lines[i].substr(at)};
  }
  return unit_of_title(text, end);
}

// A title such as "VELOCITY TIME HISTORY".
const char* quantity_of(std::string_view line) {
  const std::string capitals = in_capitals(line);
  const auto names = [&](std::string_view quantity) {
    const bool is_title = states_time_history(capitals) || has(capitals, "UNIT");
    return trimmed(capitals).starts_with(quantity) || (is_title && has(capitals, quantity));
  };
  if (names("ACCEL")) return nullptr;
  if (names("VELOCITY")) return "velocity";
  return names("DISPLACEMENT") ? "displacement" : nullptr;
}

}  // namespace

void read_at2_unit(const MotionText& text, std::size_t end, MotionColumn& column) {
  for (std::size_t i = 0; i < end; ++i)
    if (const char* quantity = quantity_of(text.lines[i]))
      text.fail(i, fmt::format("'{}': a record of {}, expected acceleration",
                               trimmed(text.lines[i]), quantity));
  const auto found = unit_text(text, end);
  if (!found) return;
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
