// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/judge.hpp>

#include "commands.hpp"

namespace rths::app {

/// 0 if everything holds, 1 if this machine cannot tell, 2 if something does not.
inline ExitCode exit_code(bench::GateResult result) {
  if (result == bench::GateResult::Pass) return kOk;
  return result == bench::GateResult::Fail ? kFailure : kConditionNotMet;
}

}  // namespace rths::app
