// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/verdict/verdict.hpp>

#include "numbers.hpp"

namespace rths::report {

/// The contents of verdict.json.
[[nodiscard]] Json verdict_numbers(const diagnosis::Verdict& verdict);

}  // namespace rths::report
