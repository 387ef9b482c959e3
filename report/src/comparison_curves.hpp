// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/report/comparison.hpp>

#include "resemblance.hpp"

namespace rths::report {

/// The values of the first signals of a comparison that differ, in its order. Reads the files anew.
/// @param settings  of the comparison   @param most  signals
/// @throws Error as compare   @setup
[[nodiscard]] std::vector<PairedValues> curves_of(const ComparedRuns& comparison,
                                                  const ComparisonSettings& settings,
                                                  std::size_t most);

}  // namespace rths::report
