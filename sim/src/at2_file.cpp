// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

constexpr std::size_t kMostHeaderLines = 40;
constexpr double kMostSamples = 1e9, kLongestStep = 1;  // [-], [s]
constexpr double kStepTolerance = 1e-3;                 // of DT
constexpr NumberStyle kFortran{.fortran = true};
constexpr const char* kExpected =
    "expected NPTS and DT with a number each, as in 'NPTS= 4000, DT= .0050 SEC'";

struct Token {
  enum class Kind { Count, Step, Number, Sign, Milli };
  Kind kind;
  double value = 0;
};
using Tokens = std::vector<Token>;

struct At2Header {
  double count = 0, step = 0;  // [-], [s]
  std::size_t line = 0;        // of NPTS
  std::size_t end = 0;         // its last line
};

// "DT= 0,005": the comma is decimal if there is no point.
std::string with_points(std::string_view line) {
  std::string result{line};
  if (line.find('.') != std::string_view::npos) return result;
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  for (std::size_t i = 1; i + 1 < result.size(); ++i)
    if (result[i] == ',' && is_digit(result[i - 1]) && is_digit(result[i + 1])) result[i] = '.';
  return result;
}

void add_word(std::string_view word, Tokens& tokens) {
  if (word == "npts" || word == "npt") tokens.push_back({Token::Kind::Count});
  if (word == "dt") tokens.push_back({Token::Kind::Step});
  if (word == "ms" || word == "msec") tokens.push_back({Token::Kind::Milli});
}

// Words, numbers and signs of equality, in order; other words are left out.
Tokens tokens_of(std::string_view line) {
  const std::string text = in_small_letters(with_points(line));
  Tokens tokens;
  std::string_view rest{text};
  double number = 0;
  while (!rest.empty()) {
    if (take_number(rest, number, {})) {
      tokens.push_back({Token::Kind::Number, number});
      continue;
    }
    std::size_t length = 0;
    while (length < rest.size() && rest[length] >= 'a' && rest[length] <= 'z') ++length;
    if (length > 0) add_word(rest.substr(0, length), tokens);
    if (rest.front() == '=' || rest.front() == ':') tokens.push_back({Token::Kind::Sign});
    rest.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return tokens;
}

std::size_t count_of(const Tokens& tokens, Token::Kind kind) {
  return static_cast<std::size_t>(
      std::ranges::count_if(tokens, [&](const Token& token) { return token.kind == kind; }));
}

bool is_name(const Token& token) {
  return token.kind == Token::Kind::Count || token.kind == Token::Kind::Step;
}

// The number after a name, with or without a sign of equality.
std::optional<double> number_after(const Tokens& tokens, std::size_t name) {
  std::size_t at = name + 1;
  if (at < tokens.size() && tokens[at].kind == Token::Kind::Sign) ++at;
  if (at < tokens.size() && tokens[at].kind == Token::Kind::Number) return tokens[at].value;
  return std::nullopt;
}

bool has_sign(const Tokens& tokens, std::size_t name) {
  return name + 1 < tokens.size() && tokens[name + 1].kind == Token::Kind::Sign;
}

std::vector<double> numbers_of(const Tokens& tokens, std::size_t begin, std::size_t end) {
  std::vector<double> numbers;
  for (std::size_t i = begin; i < end; ++i)
    if (tokens[i].kind == Token::Kind::Number) numbers.push_back(tokens[i].value);
  return numbers;
}

using Pair = std::pair<double, double>;

// Values of the two names, in their order. None: there is more than one way to read them.
std::optional<Pair> assigned(const Tokens& tokens) {
  const auto found = std::ranges::find_if(tokens, is_name);
  const auto other = std::find_if(found + 1, tokens.end(), is_name);
  const auto first = static_cast<std::size_t>(found - tokens.begin());
  const auto second = static_cast<std::size_t>(other - tokens.begin());
  const auto before = numbers_of(tokens, 0, first), between = numbers_of(tokens, first, second),
             after = numbers_of(tokens, second, tokens.size());
  const auto one = number_after(tokens, first), two = number_after(tokens, second);
  const bool has_signs = has_sign(tokens, first) && has_sign(tokens, second);
  if (one && two && (before.empty() || has_signs)) return Pair{*one, *two};
  if (before.size() == 1 && between.size() == 1 && after.empty())
    return Pair{before[0], between[0]};
  if (!between.empty()) return std::nullopt;
  if (before.empty() && two && after.size() >= 2) return Pair{after[0], after[1]};
  if (before.size() == 2 && after.empty()) return Pair{before[0], before[1]};
  return std::nullopt;
}

// NPTS and DT of one line, or of two adjacent ones.
Tokens tokens_of_header(const MotionText& text, At2Header& header) {
  Tokens tokens = tokens_of(text.lines[header.line]);
  if (count_of(tokens, Token::Kind::Step) > 0) return tokens;
  if (header.line + 1 < text.lines.size()) {
    const Tokens next = tokens_of(text.lines[header.line + 1]);
    if (count_of(next, Token::Kind::Step) > 0) {
      tokens.insert(tokens.end(), next.begin(), next.end());
      header.end = header.line + 1;
      return tokens;
    }
  }
  Tokens above = header.line > 0 ? tokens_of(text.lines[header.line - 1]) : Tokens{};
  if (count_of(above, Token::Kind::Step) == 0) return tokens;
  above.insert(above.end(), tokens.begin(), tokens.end());
  return above;
}

// "NPTS, DT" alone: the numbers are in the line above or below.
void add_adjacent_numbers(const MotionText& text, At2Header& header, Tokens& tokens) {
  const auto two_numbers = [&](std::size_t line) {
    std::vector<double> numbers;
    return line < text.lines.size() && is_row(text.lines[line], {}) &&
           add_numbers(text.lines[line], {}, numbers).empty() && numbers.size() == 2;
  };
  const bool is_above = header.line > 0 && two_numbers(header.line - 1);
  if (!is_above && !two_numbers(header.end + 1)) return;
  const Tokens numbers = tokens_of(text.lines[is_above ? header.line - 1 : header.end + 1]);
  tokens.insert(is_above ? tokens.begin() : tokens.end(), numbers.begin(), numbers.end());
  if (!is_above) ++header.end;
}

std::optional<std::size_t> line_of_count(const MotionText& text) {
  for (std::size_t i = 0; i < std::min(text.lines.size(), kMostHeaderLines); ++i)
    if (count_of(tokens_of(text.lines[i].substr(0, 200)), Token::Kind::Count) > 0) return i;
  return std::nullopt;
}

At2Header read_header(const MotionText& text) {
  const auto line = line_of_count(text);
  if (!line)
    throw Error{fmt::format("{}: no NPTS in the header, {}", text.file.string(), kExpected)};
  At2Header header{.line = *line, .end = *line};
  const auto fail = [&](const std::string& found) {
    text.fail(header.line, fmt::format("{} in '{}', {}", found,
                                       trimmed(text.lines[header.line].substr(0, 100)), kExpected));
  };
  Tokens tokens = tokens_of_header(text, header);
  if (count_of(tokens, Token::Kind::Step) == 0) fail("DT not found");
  if (count_of(tokens, Token::Kind::Step) > 1 || count_of(tokens, Token::Kind::Count) > 1)
    fail("several NPTS or DT");
  if (count_of(tokens, Token::Kind::Number) == 0) add_adjacent_numbers(text, header, tokens);
  // "DT (MSEC) = 5"
  const bool is_milli = std::erase_if(tokens, [](const Token& token) {
                          return token.kind == Token::Kind::Milli;
                        }) > 0;
  const auto values = assigned(tokens);
  if (!values) fail("numbers are not assigned");
  const bool is_count_first = std::ranges::find_if(tokens, is_name)->kind == Token::Kind::Count;
  header.count = is_count_first ? values->first : values->second;
  header.step = is_count_first ? values->second : values->first;
  if (is_milli) header.step *= 1e-3;
  if (!(header.count >= 2 && header.count < kMostSamples) ||
      header.count != std::floor(header.count))
    fail(fmt::format("NPTS is {:g}, expected a whole number above 1,", header.count));
  if (!(header.step > 0 && header.step <= kLongestStep))
    fail(fmt::format("DT is {:g} s, expected a positive time of at most {:g} s,", header.step,
                     kLongestStep));
  return header;
}

// Text that begins with a number, such as "2 POLES, .1 HZ".
bool is_remark(std::string_view line) {
  const auto words = cells_of(line, ' ');
  const auto numbers =
      std::ranges::count_if(words, [](auto word) { return is_row(word, kFortran); });
  return 2 * static_cast<std::size_t>(numbers) <= words.size();
}

// Headers of seven lines have text below NPTS, too. Values begin with a number.
std::size_t first_value(const MotionText& text, std::size_t at) {
  for (double number = 0; at < std::min(text.lines.size(), 2 * kMostHeaderLines); ++at) {
    std::string_view line = trimmed(text.lines[at]);
    if (take_number(line, number, kFortran) && !is_remark(text.lines[at])) break;
  }
  return at;
}

// Columns may keep the header: NPTS counts their rows.
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

// Reads the unit in the header into the heading of the column.
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

MotionFile read_with_time(const MotionText& text, const At2Header& header) {
  MotionFile motion = read_columns(text);
  if (std::abs(motion.time_step - header.step) > kStepTolerance * header.step)
    text.fail(header.line, fmt::format("DT is {:g} s, but the first column has steps of {:g} s",
                                       header.step, motion.time_step));
  return motion;
}

// The names of records of velocity and displacement, where the header does not say so.
void reject_other_quantity(const MotionText& text, const MotionColumn& column) {
  if (column.stated.unit != nullptr) return;
  const std::string ending = in_small_letters(text.file.extension().string());
  for (const auto& [other, quantity] :
       {std::pair{".vt2", "velocity"}, std::pair{".dt2", "displacement"}})
    if (ending == other)
      throw Error{
          fmt::format("{}: its name is that of a record of {}, expected acceleration, or "
                      "'ACCELERATION TIME SERIES IN UNITS OF G' in the header",
                      text.file.string(), quantity)};
}

}  // namespace

bool has_at2_header(const MotionText& text) {
  if (line_of_count(text)) return true;
  for (std::size_t i = 0; i < std::min(text.lines.size(), kMostHeaderLines); ++i) {
    if (is_row(text.lines[i], kFortran)) return false;
    const std::string small = in_small_letters(text.lines[i]);
    if (states_time_history(small) && small.find("units of") != std::string::npos) return true;
  }
  return false;
}

MotionFile read_at2(const MotionText& text) {
  const At2Header header = read_header(text);
  MotionFile motion{text.file, ".AT2", header.step, {}};
  MotionColumn column;
  const std::size_t begin = first_value(text, header.end + 1);
  read_at2_unit(text, begin, column);
  reject_other_quantity(text, column);
  std::size_t rows = 0;
  for (std::size_t i = begin; i < text.lines.size(); ++i) {
    const std::size_t before = column.values.size();
    if (const auto word = add_numbers(text.lines[i], kFortran, column.values); !word.empty())
      text.fail(i, fmt::format("'{}' is not a number", word.substr(0, 40)));
    if (column.values.size() > before) ++rows;
  }
  const auto count = static_cast<std::size_t>(header.count), found = column.values.size();
  if (found != count && rows == count && found % count == 0) return read_with_time(text, header);
  if (found != count)
    text.fail(std::max<std::size_t>(text.lines.size(), 1) - 1,
              fmt::format("{} values found, expected NPTS = {}", found, count));
  motion.columns.push_back(std::move(column));
  return motion;
}

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

}  // namespace rths::sim
