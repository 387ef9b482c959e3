// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/investigation.hpp>
#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

/// Adds what the records and the comparison leave open: the source of the noise, the filter,
/// channels that are missing or not used, gaps, and states that were never visited.
void add_limits(const Case& c, const SensorNoise& noise,
                const std::vector<std::unique_ptr<Investigation>>& all, Verdict& verdict);

/// What the absence of channels leaves open, and channels that no relation uses.
[[nodiscard]] std::vector<std::string> limits_of_channels(const Case& c);

/// Outputs whose measurement opposes the prediction of the stated model: their sign may be wrong.
[[nodiscard]] std::vector<std::string> opposed_outputs(const Relation& relation,
                                                       const std::vector<const Record*>& records);

/// How to measure the noise, if no section at rest is known: with the first section of a record
/// that seems to be at rest.
[[nodiscard]] std::string remedy_for_noise(const Case& c);

}  // namespace rths::diagnosis
