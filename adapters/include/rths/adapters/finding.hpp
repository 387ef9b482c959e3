// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace rths::adapters {

/// Result of one rule of a conformance suite.
struct Finding {
  enum class Outcome { Pass, Fail, NotTried };
  std::string rule;
  Outcome outcome = Outcome::NotTried;
  std::string text;  ///< found and expected, and the remedy of a Fail
};

}  // namespace rths::adapters
