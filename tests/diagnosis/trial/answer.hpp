// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "trial_case.hpp"

namespace trial {

/// How much of the truth is computed.
enum class TruthDepth {
  None,  ///< what is concealed, with its numbers
  Full,  ///< information, separations, place and floor too
};

/// What a case conceals, as JSON.
std::string answer(const TrialCase& trial, TruthDepth depth);

}  // namespace trial
