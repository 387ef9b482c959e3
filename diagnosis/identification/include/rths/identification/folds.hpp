// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// Records for the selection, and records for the proof.
struct Split {
  std::vector<const Record*> records;  ///< of the problem: fitted and scored
  std::vector<const Record*> held;     ///< not used before the proof
  /// Each fold is of whole records: the first held-out one scores those that are fitted.
  bool by_record = false;
  /// A recorded state that is constant in one of two folds of whole records, so that such a fold
  /// determines no law of it. The folds are then pieces of all records. Empty: there is none.
  std::string undetermined = {};  // NOLINT(readability-redundant-member-init)
};

/// Splits the records of a case. Of exactly two held-out records, the first scores the fits if
/// fewer than four records are fitted. Otherwise the fitted records, or their pieces, score each
/// other.
[[nodiscard]] Split split_of(const std::vector<Record>& records);

/// Folds of the problem of a split, without the rows near gaps of the records.
[[nodiscard]] Folds folds_of(const Split& split, const Problem& problem);

}  // namespace rths::diagnosis
