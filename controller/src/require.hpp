// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::controller {

/// Refuses a wrong setting: "safety: jump is -1, expected …".
struct Require {
  const char* subject;

  /// @throws Error unless it holds   @setup
  void operator()(bool holds, const char* name, double value, const char* expected) const {
    if (!holds)
      throw Error{fmt::format("{}: {} is {:g}, expected {}", subject, name, value, expected)};
  }
  /// @throws Error unless the value is positive   @setup
  void positive(const char* name, double value) const {
    (*this)(value > 0, name, value, "a positive number");
  }
  /// @throws Error unless the value is 0 or more   @setup
  void zero_or_more(const char* name, double value) const {
    (*this)(value >= 0, name, value, "0 or more");
  }
};

}  // namespace rths::controller
