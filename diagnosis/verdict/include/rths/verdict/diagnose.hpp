// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/cases/case.hpp>
#include <rths/identification/progress.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

struct DiagnosisOptions {
  std::vector<std::string> without;       ///< excluded kinds of the catalogue, or names in verdicts
  std::uint64_t seed = 1;                 ///< of noise realisations and resampling
  DiagnosisProgress::Show progress = {};  // NOLINT: called at every step
};

/// Finds the physics that the simulation of a case left out.
/// @throws Error that names the channel or setting that the model needs and the case lacks   @setup
[[nodiscard]] Verdict diagnose(const Case& c, const DiagnosisOptions& options = {});

}  // namespace rths::diagnosis
