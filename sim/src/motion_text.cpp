// SPDX-License-Identifier: Apache-2.0
#include "motion_text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::sim {
namespace {

bool is_sign(char c) { return c == '+' || c == '-'; }

std::size_t digits_from(std::string_view text, std::size_t at) {
  while (at < text.size() && is_digit(text[at])) ++at;
  return at;
}

// "-12.5"; 0: there are no digits.
std::size_t length_of_mantissa(std::string_view text) {
  const std::size_t begin = !text.empty() && is_sign(text.front()) ? 1 : 0;
  std::size_t end = digits_from(text, begin), digits = end - begin;
  if (end < text.size() && text[end] == '.') {
    const std::size_t fraction = end + 1;
    end = digits_from(text, fraction);
    digits += end - fraction;
  }
  return digits == 0 ? 0 : end;
}

// The exponent of ".291-03", behind a mantissa with a point. A number that touches has a point too.
std::size_t length_of_bare_exponent(std::string_view mantissa, std::string_view rest) {
  const bool has_letter = mantissa.find_first_of("eEdD") != mantissa.npos;
  if (has_letter || mantissa.find('.') == mantissa.npos || rest.empty() || !is_sign(rest[0]))
    return 0;
  const std::size_t end = digits_from(rest, 1);
  const bool is_number =
      end < rest.size() && std::string_view{".eEdD"}.find(rest[end]) != rest.npos;
  return (end == 3 || end == 4) && !is_number ? end : 0;
}

// Length of the number at the start of a text; 0: there is none.
std::size_t length_of_number(std::string_view text) {
  const std::size_t end = length_of_mantissa(text);
  if (end == 0 || end == text.size() ||
      std::string_view{"eEdD"}.find(text[end]) == std::string_view::npos)
    return end;
  const std::size_t power = end + 1 < text.size() && is_sign(text[end + 1]) ? end + 2 : end + 1;
  const std::size_t after = digits_from(text, power);
  return after > power ? after : end;
}

bool is_between(char c) {
  return std::string_view{" \t\n\v\f\r;\","}.find(c) != std::string_view::npos;
}

// Numbers of a word, such as the two of "2.91E-03-5.62E-04".
bool add_word(std::string_view word, NumberStyle style, std::vector<double>& numbers) {
  double number = 0;
  while (take_number(word, number, style)) {
    numbers.push_back(number);
    if (word.empty()) return true;
    if (!style.fortran || !is_sign(word.front())) return false;
  }
  return false;
}

}  // namespace

void MotionText::fail(std::size_t line, const std::string& problem) const {
  throw Error{fmt::format("{}:{}: {}", file.string(), line + 1, problem)};
}

TimeSteps time_steps(const std::vector<double>& stamps) {
  constexpr double kTolerance = 1e-3;  // of a step: precision of three printed decimals
  constexpr double kRounding = 6e-4;   // [s]
  if (stamps.size() < 2) return {};
  const double begin = stamps.front();
  TimeSteps steps{(stamps.back() - begin) / static_cast<double>(stamps.size() - 1), {}};
  const double most = std::max(kTolerance * steps.step, kRounding);
  for (std::size_t i = 1; i < stamps.size() && !steps.wrong; ++i)
    if (std::abs(stamps[i] - begin - static_cast<double>(i) * steps.step) > most) steps.wrong = i;
  return steps;
}

bool states_time_history(std::string_view small) {
  return small.find("time history") != std::string_view::npos ||
         small.find("time series") != std::string_view::npos;
}

bool take_number(std::string_view& text, double& number, NumberStyle style) {
  std::array<char, 64> digits{};
  const std::size_t length = length_of_number(text);
  const auto written = text.substr(0, length);
  const std::size_t bare =
      style.fortran ? length_of_bare_exponent(written, text.substr(length)) : 0;
  if (length == 0 || length + bare >= digits.size()) return false;
  char* end = std::transform(written.begin(), written.end(), digits.data(),
                             [](char c) { return c == 'd' || c == 'D' ? 'e' : c; });
  if (bare > 0) *end++ = 'e';
  end = std::copy_n(text.data() + length, bare, end);
  const char* begin = digits.data() + (digits[0] == '+' ? 1 : 0);
  const auto [stopped, problem] = std::from_chars(begin, static_cast<const char*>(end), number);
  if (problem != std::errc{} || stopped != end || !std::isfinite(number)) return false;
  text.remove_prefix(length + bare);
  return true;
}

std::string_view add_numbers(std::string_view line, NumberStyle style,
                             std::vector<double>& numbers) {
  const char* at = line.data();
  const char* end = at + line.size();
  while (true) {
    at = std::find_if_not(at, end, is_between);
    if (at == end) return {};
    const char* after = std::find_if(at, end, is_between);
    const std::string_view word{at, static_cast<std::size_t>(after - at)};
    if (!add_word(word, style, numbers)) return word;
    at = after;
  }
}

bool is_row(std::string_view line, NumberStyle style) {
  std::vector<double> numbers;
  return add_numbers(line, style, numbers).empty() && !numbers.empty();
}

}  // namespace rths::sim
