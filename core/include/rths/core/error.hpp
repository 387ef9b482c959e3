// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>

namespace rths {

/// The one exception of the project, thrown while setting up and caught once, in the command.
///
/// `what()` is a single line that says where, what was found, and what was expected:
///     throw Error{"bearing.toml:14:1: stroke_limit_m is 2.0, the machine allows 1.2"};
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Stops the process with the broken claim on standard error. For our own bugs, never for input.
[[noreturn]] void assertion_failed(const char* claim, const char* file, int line) noexcept;

}  // namespace rths

/// Checks an invariant of our own code. Off when NDEBUG is defined.
#ifdef NDEBUG
#define RTHS_ASSERT(claim) static_cast<void>(0)
#else
#define RTHS_ASSERT(claim) \
  ((claim) ? static_cast<void>(0) : ::rths::assertion_failed(#claim, __FILE__, __LINE__))
#endif
