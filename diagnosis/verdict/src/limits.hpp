// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/cases/case.hpp>
#include <rths/verdict/verdict.hpp>

#include "report.hpp"

namespace rths::diagnosis {

/// Why the folds are pieces of all records. @param split  with an undetermined state
[[nodiscard]] std::string pieces_for(const Split& split);
[[nodiscard]] NoiseBasis noise_basis(const Case& c, const SensorNoise& noise);

/// What the records and the comparison leave open: the source of the noise, the filter, channels
/// that are missing or not used, gaps, and states that were never visited.
[[nodiscard]] std::vector<std::string> limits_of(const Case& c, const SensorNoise& noise,
                                                 const AllFindings& all);

/// What the absence of channels leaves open, and channels that no relation uses.
[[nodiscard]] std::vector<std::string> limits_of_channels(const Case& c);

/// Outputs whose measurement opposes the prediction of the stated model: their sign may be wrong.
[[nodiscard]] std::vector<std::string> opposed_outputs(const Relation& relation,
                                                       const std::vector<const Record*>& records);

}  // namespace rths::diagnosis
