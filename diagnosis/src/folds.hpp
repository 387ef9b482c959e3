// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "selection.hpp"

namespace rths::diagnosis {

/// Which records find, and which one proves.
struct Split {
  std::vector<const Record*> records;  ///< of the problem: those that find
  std::vector<const Record*> held;     ///< never touched before the proof
  bool by_record = false;              ///< the folds are records, not pieces of one
};

/// With two held-out records or more, all but the last of them score what was fitted. With one, or
/// none, the records that are fitted score each other, or their pieces do.
[[nodiscard]] Split split_of(const Case& c);

/// Folds of the split's problem.
[[nodiscard]] Folds folds_of(const Split& split, const Problem& problem);

}  // namespace rths::diagnosis
