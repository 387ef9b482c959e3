// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

/// How often a name like this one is right: a logistic function of what speaks against it, fitted
/// to names in cases with known answers, benchmarks/results/confidence.json.
/// @param relation  that names the cause
[[nodiscard]] double confidence_in(const Cause& cause, const RelationVerdict& relation);

/// The lowest confidence of any cause; without causes, how often a verdict like this one is right.
/// @param is_noise_known  in all relations
[[nodiscard]] double confidence_in_outcome(const Conclusion& conclusion, bool is_noise_known);

/// Whether there are guesses, and no other cause.
[[nodiscard]] bool are_guesses(const std::vector<Cause>& causes);

/// A guess is no cause: beside causes it is a remainder, and alone it leaves unknown what is
/// missing.
void doubt_guesses(Conclusion& conclusion);

/// "9 of 10": never more than the share.
[[nodiscard]] std::string frequency_of(double share);

}  // namespace rths::diagnosis
