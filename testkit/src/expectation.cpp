// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/expectation.hpp>

#include <cmath>

#include <fmt/format.h>

#include <rths/memmap/units.hpp>

namespace rths::testkit {
namespace {

constexpr double kRelative = 1e-6, kSmallest = 1e-12;  // of a tolerance that is not given

}  // namespace

Condition Condition::of(SignalRing& ring, const std::string& signal) const {
  if (met_) return *this;
  const double expected = ring.number(ring.entry(signal), expected_);
  const double tolerance = tolerance_;
  const auto* const name = std::get_if<std::string>(&expected_);
  std::string text = name != nullptr ? *name : quantity(ring, signal, expected);
  if (tolerance > 0) text += fmt::format(" ± {:g}", tolerance);
  return {[=](double value) {
            const double bound =
                tolerance >= 0 ? tolerance : std::fmax(kRelative * std::fabs(expected), kSmallest);
            return std::fabs(value - expected) <= bound;
          },
          std::move(text)};
}

Condition above(double limit) {
  return {[=](double value) { return value > limit; }, fmt::format("above {:g}", limit)};
}

Condition below(double limit) {
  return {[=](double value) { return value < limit; }, fmt::format("below {:g}", limit)};
}

std::string quantity(SignalRing& ring, const std::string& signal, double value) {
  const std::string unit = memmap::parse_unit(ring.entry(signal).signal->unit).si;
  return unit == "1" ? fmt::format("{:.7g}", value) : fmt::format("{:.7g} {}", value, unit);
}

}  // namespace rths::testkit
