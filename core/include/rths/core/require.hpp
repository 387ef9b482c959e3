// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace rths {

/// Refuses a wrong setting: "safety: jump is -1, expected …".
struct Require {
  const char* subject;

  /// @throws Error unless it holds   @setup
  void operator()(bool holds, std::string_view name, double value, std::string_view expected) const;
  /// @throws Error unless the value is positive   @setup
  void positive(std::string_view name, double value) const {
    (*this)(value > 0, name, value, "a positive number");
  }
  /// @throws Error unless the value is 0 or more   @setup
  void zero_or_more(std::string_view name, double value) const {
    (*this)(value >= 0, name, value, "0 or more");
  }
};

}  // namespace rths
