// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "selection.hpp"

namespace rths::diagnosis {

/// Describes what remains without naming it: curves and surfaces over what was recorded, a line in
/// the spectrum, a sudden change. Fitted to one fold, judged by the share of the other's energy
/// beyond the noise that it explains; best first.
[[nodiscard]] std::vector<Description> describe(const Supposition& supposition, const Folds& folds);

}  // namespace rths::diagnosis
