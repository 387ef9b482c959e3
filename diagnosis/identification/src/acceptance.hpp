// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// What a model has to gain over another one [nat].
struct Threshold {
  double gain;   ///< in all
  double event;  ///< by an event that many resampled records lack
};

/// Returns true if a model gains more than a threshold over another one, also in resampled records.
/// @param differences  of the held-out scores, by block [nat]
[[nodiscard]] bool is_beneficial(const std::vector<double>& differences, const Threshold& least,
                                 std::uint64_t seed);

/// Returns true if a candidate gains more than the threshold, and gains in resampled records.
[[nodiscard]] bool is_acceptable(const ScoredCandidate& scored, const Threshold& accepted,
                                 std::uint64_t seed);

/// Removes and returns candidates that must wait for another acceptable one, see Candidate::after.
/// @param holder  one that has waited already; may be null
[[nodiscard]] std::vector<ScoredCandidate> held_back(std::vector<ScoredCandidate>& ranked,
                                                     const Candidate* holder,
                                                     const Threshold& accepted, std::uint64_t seed);

/// Chooses the cheapest of the candidates that are not significantly worse than the best. Where
/// even the best leaves much, its form is not exact: candidates that leave little more are tied
/// with it, but do not replace it.
/// @param ranked  at least one, best first
/// @param rest    energy beyond the noise that the best leaves [nat]
[[nodiscard]] SelectionRound chosen(std::vector<ScoredCandidate> ranked, double rest,
                                    std::uint64_t seed);

}  // namespace rths::diagnosis
