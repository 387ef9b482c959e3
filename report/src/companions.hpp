// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

#include "analysis.hpp"

namespace rths::report {

/// Recordings with a model instead of the specimen; null if there is none.
struct CompanionRecordings {
  const Reader* numerical;
  const Reader* improved;
};

/// Results of the analysed axes with a model instead of the specimen.
/// @param step  integration step of the run [s]
[[nodiscard]] CompanionAnalysis analyse_companions(const Reader& run, const Roles& roles,
                                                   double step,
                                                   const std::vector<AxisAnalysis>& axes,
                                                   const CompanionRecordings& companions);

/// Of the tested axes whose targets are recorded.
/// @param step  integration step of the run [s]
[[nodiscard]] std::vector<NumericalAxis> numerical_axes(const Reader& run, const Roles& roles,
                                                        double step, const Reader& numerical);

/// Response and floor spectra of another test, such as the same test at another speed.
/// @throws Error if it lacks an axis of this one
void add_beside(Analysis& analysis, const std::filesystem::path& folder);

}  // namespace rths::report
