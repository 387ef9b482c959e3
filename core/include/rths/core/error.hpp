// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rths {

/// The exception of the project: thrown during setup, caught once, in the command.
///
/// `what()` is a single line: place, found, expected. Control characters, such as those of a name
/// in a file, are escaped: \n, \x1b. Several mistakes of a map are a line each.
///     throw Error{"bearing.toml:14:1: stroke_limit_m is 2.0, the machine allows 1.2"};
class Error : public std::runtime_error {
 public:
  explicit Error(const std::string& line);
  explicit Error(const std::vector<std::string>& lines);
};

/// The text with its control characters escaped, for a terminal.
[[nodiscard]] std::string printable(std::string_view text);

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

/// Prints the failed claim on standard error and aborts. For bugs of our own, never for input.
[[noreturn]] void assertion_failed(const char* claim, const char* file, int line) noexcept;

}  // namespace rths

/// Checks an invariant of our own code. Disabled by NDEBUG.
#ifdef NDEBUG
#define RTHS_ASSERT(claim) static_cast<void>(0)
#else
#define RTHS_ASSERT(claim) \
  ((claim) ? static_cast<void>(0) : ::rths::assertion_failed(#claim, __FILE__, __LINE__))
#endif
