// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/identification/intervals.hpp>

namespace rths::diagnosis {

/// "5.7 %", "0.84 %", "120 %": a fraction with two digits.
[[nodiscard]] std::string percent_of(double fraction);

/// "41", "0.0020", "410": two digits, without an exponent where a person reads it more easily.
[[nodiscard]] std::string two_digits(double value);

/// "41 ± 0.7 kN", "8.2 ± 0.3 MJ": value with two digits and half its interval with one, in a unit
/// with a prefix. A value per joule or metre is told as its inverse.
[[nodiscard]] std::string with_interval(const Estimate& estimate);

}  // namespace rths::diagnosis
