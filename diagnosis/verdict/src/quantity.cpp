// SPDX-License-Identifier: Apache-2.0
#include "quantity.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::diagnosis {
namespace {

constexpr int kDigits = 2;
constexpr double kRounded = 0.995;  // shown with two digits, this is 1

struct Prefix {
  double factor;
  std::string_view text;
};
constexpr std::array kPrefixes{Prefix{1e9, "G"},  Prefix{1e6, "M"},   Prefix{1e3, "k"},
                               Prefix{1, ""},     Prefix{1e-3, "m"},  Prefix{1e-6, "µ"},
                               Prefix{1e-9, "n"}, Prefix{1e-12, "p"}, Prefix{1e-15, "f"}};

// Without an exponent where a person reads it more easily.
std::string with_digits(double value, int digits) {
  if (!std::isfinite(value)) return "-";
  if (value == 0) return "0";
  constexpr double kMostPlain = 1e6, kLeastPlain = 1e-7;
  const double size = std::abs(value);
  if (size >= kMostPlain || size < kLeastPlain) return fmt::format("{:.{}g}", value, digits);
  const double rounded = maths::rounded(value, digits);
  const int power = static_cast<int>(std::floor(std::log10(std::abs(rounded)) + 1e-9));
  return fmt::format("{:.{}f}", rounded, std::max(0, digits - 1 - power));
}

// Units whose first factor takes a prefix. Nobody says kilometre, kilosecond or megagram of a test.
bool takes(std::string_view unit, double factor) {
  const auto begins_with = [&](std::string_view first) {
    return unit.starts_with(first) &&
           (unit.size() == first.size() || !is_letter_or_digit(unit[first.size()]));
  };
  const auto is_any_of = [&](std::initializer_list<std::string_view> units) {
    return std::any_of(units.begin(), units.end(), begins_with);
  };
  if (factor == 1) return true;
  if (is_any_of({"N", "Pa", "J", "W", "V", "A"})) return true;
  return factor < 1 && is_any_of({"m", "s", "rad"});
}

struct Shown {
  double value, half;
  std::string unit;
};

// 1.2e-7 1/J is 8.2 MJ; 2e-9 m/N is 2 mm/MN.
Shown in_plain_unit(const Estimate& estimate) {
  const double half = (estimate.high - estimate.low) / 2;
  if (estimate.unit.starts_with("1/") && estimate.value != 0)
    return {1 / estimate.value, half / (estimate.value * estimate.value), estimate.unit.substr(2)};
  if (estimate.unit == "m/N") return {estimate.value * 1e9, half * 1e9, "mm/MN"};
  if (estimate.unit == "-") return {estimate.value, half, ""};
  std::string unit = estimate.unit;
  replace_all(unit, "*", " ");
  return {estimate.value, half, unit};
}

}  // namespace

std::string two_digits(double value) { return with_digits(value, kDigits); }

std::string percent_of(double fraction) { return two_digits(100 * fraction) + " %"; }

std::string with_interval(const Estimate& estimate) {
  Shown shown = in_plain_unit(estimate);
  const double size = std::abs(shown.value);
  const auto prefix = std::find_if(kPrefixes.begin(), kPrefixes.end(), [&](const Prefix& one) {
    return takes(shown.unit, one.factor) && size >= kRounded * one.factor;
  });
  if (prefix != kPrefixes.end()) {
    shown.value /= prefix->factor;
    shown.half /= prefix->factor;
    shown.unit.insert(0, prefix->text);
  }
  const std::string unit = shown.unit.empty() ? "" : " " + shown.unit;
  return std::isfinite(shown.half) && shown.half > 0
             ? fmt::format("{} ± {}{}", two_digits(shown.value), with_digits(shown.half, 1), unit)
             : two_digits(shown.value) + unit;
}

}  // namespace rths::diagnosis
