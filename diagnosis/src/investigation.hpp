// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/diagnosis/diagnose.hpp>

#include "folds.hpp"

namespace rths::diagnosis {

/// One relation of a case, with what was found about it.
struct Investigation {
  std::unique_ptr<Relation> relation;
  const SensorNoise* noise;
  std::uint64_t seed;
  Split split;
  Record first;  ///< of the records, as it was: what is found of a sensor is corrected in them
  std::unique_ptr<Problem> problem;  ///< of the records that find
  std::unique_ptr<Problem> proof;    ///< of those that were held out; null if none was
  Folds folds;
  Selection selection;
  std::vector<Description> descriptions;  ///< of what remains, if something does

  [[nodiscard]] bool is_named() const { return !selection.steps.empty(); }
  /// Something systematic is left that the named terms do not explain.
  [[nodiscard]] bool is_unknown() const;
};

/// The noise must outlive what is found.
[[nodiscard]] std::unique_ptr<Investigation> investigate(std::unique_ptr<Relation> relation,
                                                         const Case& c, const SensorNoise& noise,
                                                         std::uint64_t seed);

/// Errors of a hypothesis on a record: root mean square over the standard deviation of what was
/// measured, offset removed.
[[nodiscard]] double nrmse(const Supposition& supposition, std::size_t record);
[[nodiscard]] RecordScore score_of(const Investigation& found, const Problem& problem,
                                   std::size_t record);
/// Every parameter that was fitted with what was named, with its interval, which includes what the
/// noise of the measured motion does to it.
[[nodiscard]] std::vector<Estimate> estimates_of(const Investigation& found);

/// Adds what an investigation found to a verdict: causes, scores, evidence, proof, traces.
void report(const Investigation& found, Verdict& verdict);

/// TOML of the terms that were named, and of what was fitted with them, for [specimen] and
/// [machine] of an experiment; empty if nothing was named.
[[nodiscard]] std::string fragment_of(const Investigation& found);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence_of(const Verdict& verdict);

}  // namespace rths::diagnosis
