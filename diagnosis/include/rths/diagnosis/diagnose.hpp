// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/diagnosis/case.hpp>
#include <rths/diagnosis/verdict.hpp>

namespace rths::diagnosis {

struct DiagnosisOptions {
  std::vector<std::string> without;  ///< kinds of the catalogue that may not be named
  std::uint64_t seed = 1;            ///< of draws of noise and of resampling
};

/// Finds what the simulation of a case left out.
/// @throws Error if the case lacks what its model needs, saying what   @setup
[[nodiscard]] Verdict diagnose(const Case& c, const DiagnosisOptions& options = {});

}  // namespace rths::diagnosis
