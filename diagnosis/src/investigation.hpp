// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/diagnosis/diagnose.hpp>

#include "folds.hpp"

namespace rths::diagnosis {

/// One relation of a case, and the findings about it.
struct Investigation {
  std::unique_ptr<Relation> relation;
  const SensorNoise* noise;
  std::uint64_t seed;
  Split split;
  Record first;  ///< first record, before faults of sensors were corrected in it
  std::unique_ptr<Problem> problem;  ///< of the fitted and scored records
  std::unique_ptr<Problem> proof;    ///< of the held-out records; null if there are none
  Folds folds;
  Selection selection;
  std::vector<Description> descriptions;  ///< of the remaining residual, if it is systematic

  [[nodiscard]] bool is_named() const { return !selection.rounds.empty(); }
  /// Returns true if a systematic residual is left that the named terms do not explain.
  [[nodiscard]] bool is_unknown() const;
};

/// Investigates a relation of a case. The noise must outlive the result.
[[nodiscard]] std::unique_ptr<Investigation> investigate(std::unique_ptr<Relation> relation,
                                                         const Case& c, const SensorNoise& noise,
                                                         std::uint64_t seed);

/// Error of a hypothesis on a record: root mean square over the standard deviation of the
/// measurement, offset removed.
[[nodiscard]] double nrmse(const Supposition& supposition, std::size_t record);
[[nodiscard]] RecordScore score_of(const Investigation& found, const Problem& problem,
                                   std::size_t record);
/// Every parameter that was fitted with the named terms, with its interval. The interval includes
/// the effect of noise in the measured motion.
[[nodiscard]] std::vector<Estimate> estimates_of(const Investigation& found);

/// Adds the findings of an investigation to a verdict: causes, scores, evidence, proof, traces.
void report(const Investigation& found, Verdict& verdict);

/// TOML of the named terms, and of the parameters fitted with them, for [specimen] and [machine] of
/// an experiment; empty if nothing was named.
[[nodiscard]] std::string fragment_of(const Investigation& found);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence_of(const Verdict& verdict);

}  // namespace rths::diagnosis
