// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace rths::diagnosis {
namespace {

constexpr double kLeastGain = 1e-3;  // [nat]

// Coefficients of benchmarks/results/confidence.json [-]; a test compares them. Each lowers the
// logarithm of the odds that a name is right.
constexpr double kMost = 0.99;
constexpr double kIntercept = 4.498;
constexpr double kRivals = 1.072;
constexpr double kRarelyBest = 1.15;
constexpr double kLeft = 4.365;
constexpr double kRemainder = 1.26;
constexpr double kOneChannel = 2.797;
constexpr double kBeside = 1.89;
constexpr double kParts = 3.098;
constexpr double kNotHeldOut = 1;
constexpr double kNoiseUnknown = 0.717;

}  // namespace

double confidence_in(const Cause& cause, const RelationVerdict& relation) {
  const auto rivals = static_cast<double>(cause.alternatives.size());
  const auto named = static_cast<double>(std::max<std::size_t>(1, relation.causes.size()));
  double against = kRivals * std::log1p(rivals) + kRarelyBest * (1 - cause.support.best) +
                   kLeft * std::log1p(relation.left / std::max(cause.support.gain, kLeastGain)) +
                   (kBeside + (relation.common_law.empty() ? 0 : kParts)) * std::log(named);
  if (relation.has_remainder) against += kRemainder;
  if (relation.has_remainder && relation.outputs.size() == 1) against += kOneChannel;
  if (!relation.is_held_out) against += kNotHeldOut;
  if (!relation.proof.is_noise_known) against += kNoiseUnknown;
  return std::min(kMost, 1 / (1 + std::exp(against - kIntercept)));
}

double confidence_in_outcome(const Conclusion& conclusion, bool is_noise_known) {
  // Shares of such verdicts that were right in the same cases [-]. Where the noise is not known, a
  // judgement.
  constexpr double kNone = 0.96, kNoneInUnknownNoise = 0.8, kUnknownOutcome = 0.87;
  double lowest = 1;
  for (const auto& cause : conclusion.causes)
    if (!is_guess(cause)) lowest = std::min(lowest, cause.confidence);
  if (lowest < 1) return lowest;
  if (conclusion.outcome == Outcome::Unknown) return kUnknownOutcome;
  return is_noise_known ? kNone : kNoneInUnknownNoise;
}

bool are_guesses(const std::vector<Cause>& causes) {
  return !causes.empty() && std::all_of(causes.begin(), causes.end(), is_guess);
}

void doubt_guesses(Conclusion& conclusion) {
  const auto& causes = conclusion.causes;
  if (std::none_of(causes.begin(), causes.end(), is_guess)) return;
  if (are_guesses(causes)) conclusion.outcome = Outcome::Unknown;
  conclusion.has_remainder = conclusion.outcome == Outcome::Missing;
}

std::string frequency_of(double share) {
  constexpr double kNearlyAlways = 0.95;
  constexpr double kOfTen = 10;
  if (share >= kNearlyAlways) return "19 of 20";
  const double of_ten = std::floor(kOfTen * share);
  return of_ten < 1 ? "less than 1 of 10" : fmt::format("{:.0f} of 10", of_ten);
}

}  // namespace rths::diagnosis
