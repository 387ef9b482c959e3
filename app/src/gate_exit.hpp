// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/judge.hpp>

#include "commands.hpp"

namespace rths::app {

/// @returns 0 for a pass, 1 if inconclusive on this host, 2 for a fail
inline ExitCode exit_code(bench::GateResult result) {
  if (result == bench::GateResult::Pass) return kOk;
  return result == bench::GateResult::Fail ? kFailure : kConditionNotMet;
}

}  // namespace rths::app
