// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "selection.hpp"

namespace rths::diagnosis {

/// Describes the form of a residual that no term explains: curves and surfaces over recorded
/// quantities, a line in the spectrum, a sudden change. Each form is fitted to one fold and ranked
/// by the share of the other fold's energy beyond the noise that it explains; best first.
[[nodiscard]] std::vector<Description> describe(const Supposition& supposition, const Folds& folds);

}  // namespace rths::diagnosis
