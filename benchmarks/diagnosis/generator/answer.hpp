// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "trial_case.hpp"

namespace trial {

/// Content of an answer.
enum class TruthDepth {
  None,  ///< the concealed effects with their parameters
  Full,  ///< also information, separations, place and noise floor
};

/// Returns the concealed effects of a case, as JSON.
std::string answer(const TrialCase& trial, TruthDepth depth);

}  // namespace trial
