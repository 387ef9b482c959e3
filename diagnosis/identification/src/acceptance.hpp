// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// Returns true if a model gains more than `least` over another one, also in resampled records.
/// @param differences  of the held-out scores, by block [nat]   @param least  [nat]
[[nodiscard]] bool is_beneficial(const std::vector<double>& differences, double least,
                                 std::uint64_t seed);

/// Returns true if a candidate gains more than `accepted` [nat], and gains in resampled records.
[[nodiscard]] bool is_acceptable(const ScoredCandidate& scored, double accepted,
                                 std::uint64_t seed);

/// Removes and returns candidates that must wait for another acceptable one, see Candidate::after.
/// @param holder  one that has waited already; may be null
[[nodiscard]] std::vector<ScoredCandidate> held_back(std::vector<ScoredCandidate>& ranked,
                                                     const Candidate* holder, double accepted,
                                                     std::uint64_t seed);

/// Chooses the cheapest of the candidates that are not significantly worse than the best.
/// @param ranked  at least one, best first
[[nodiscard]] SelectionRound chosen(std::vector<ScoredCandidate> ranked, std::uint64_t seed);

}  // namespace rths::diagnosis
