// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/identification/folds.hpp>
#include <rths/identification/forms.hpp>
#include <rths/identification/proof.hpp>
#include <rths/identification/pruning.hpp>

namespace rths::diagnosis {

/// One relation of a case, and the findings about it.
struct RelationFindings {
  std::unique_ptr<Relation> relation;
  const SensorNoise* noise;
  std::uint64_t seed;
  Split split;
  Record first;  ///< first record, before faults of sensors were corrected in it
  std::unique_ptr<Problem> problem;   ///< of the fitted and scored records
  std::unique_ptr<Problem> held_out;  ///< of the held-out records; null if there are none
  Folds folds;
  Selection selection;
  std::vector<Withdrawn> withdrawn;  ///< selected, but not named
  Proof proof;
  std::vector<Description> descriptions;  ///< of the remaining residual, if it is systematic
  std::optional<Description> common_law;  ///< of which the named terms, two or more, are parts

  [[nodiscard]] bool is_named() const { return !selection.rounds.empty(); }
  /// Returns true if the residual that the named terms leave is systematic.
  [[nodiscard]] bool has_remainder() const;
  /// Returns true if the named terms do not explain most of the systematic residual.
  [[nodiscard]] bool is_unknown() const;
};

/// Examines a relation of a case. The noise must outlive the result.
[[nodiscard]] std::unique_ptr<RelationFindings> examine(std::unique_ptr<Relation> relation,
                                                        const std::vector<Record>& records,
                                                        const SensorNoise& noise,
                                                        std::uint64_t seed,
                                                        DiagnosisProgress& progress);

}  // namespace rths::diagnosis
