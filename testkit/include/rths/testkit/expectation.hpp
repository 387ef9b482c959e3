// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <functional>
#include <string>
#include <type_traits>
#include <utility>

#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

/// An expectation that is not met: the test fails. Its message has signal, expectation and value.
class NotMet : public Error {
 public:
  using Error::Error;
};

/// A condition of the value of a signal: a value [SI], the name of one of the signal's values, or a
/// function of the value.
class Condition {
 public:
  /// Met to 1e-6 of the value.
  template <class Number>
  requires std::is_arithmetic_v<Number> Condition(Number value)  // NOLINT: implicit, as the others
      : expected_{static_cast<double>(value)} {}
  Condition(double value, double tolerance) : expected_{value}, tolerance_{tolerance} {}
  Condition(const char* name) : expected_{std::string{name}} {}  // NOLINT
  Condition(std::string name) : expected_{std::move(name)} {}    // NOLINT
  template <std::predicate<double> Met>
  Condition(Met met, std::string text = "that the condition holds")  // NOLINT
      : met_{std::move(met)}, text_{std::move(text)} {}

  /// The condition of one signal: with its value and its unit.
  /// @throws Error if the signal has no value of this name
  [[nodiscard]] Condition of(SignalRing& ring, const std::string& signal) const;
  /// @pre of `of`, or made of a function
  [[nodiscard]] bool is_met(double value) const { return met_(value); }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  Value expected_;
  double tolerance_ = -1;  ///< [SI]; negative: relative
  std::function<bool(double)> met_;
  std::string text_;  ///< after "expected"
};

[[nodiscard]] Condition above(double limit);
[[nodiscard]] Condition below(double limit);

/// A value with the SI unit of its signal, for messages.
[[nodiscard]] std::string quantity(SignalRing& ring, const std::string& signal, double value);

}  // namespace rths::testkit
