// SPDX-License-Identifier: Apache-2.0
#include "confidence.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

namespace rths::diagnosis {
namespace {

constexpr double kLeastGain = 1e-3;  // [nat]

// Coefficients of benchmarks/results/confidence.json [-]; a test compares them. Each lowers the
// logarithm of the odds that a name is right.
constexpr double kMost = 0.99;
constexpr double kIntercept = 4.238;
constexpr double kRivals = 0.86;
constexpr double kRarelyBest = 1.718;
constexpr double kLeft = 6.169;
constexpr double kRemainder = 3.564;
constexpr double kUnknown = 0.201;
constexpr double kBeside = 2.449;
constexpr double kParts = 0;
constexpr double kNotHeldOut = 1;
constexpr double kNoiseUnknown = 0.681;

// Names of the trial and of the development cases together, by confidence: docs/verdict.md.
struct Reliability {
  double from;
  int right, names;
};
constexpr Reliability kReliability[] = {{0.95, 166 + 99, 171 + 100},
                                        {0.8, 146 + 86, 156 + 97},
                                        {0.5, 21 + 5, 36 + 17},
                                        {0, 7 + 11, 68 + 93}};

}  // namespace

double confidence_in(const Cause& cause, const RelationVerdict& relation) {
  const auto rivals = static_cast<double>(cause.alternatives.size());
  const auto named = static_cast<double>(std::max<std::size_t>(1, relation.causes.size()));
  double against = kRivals * std::log1p(rivals) + kRarelyBest * (1 - cause.support.best) +
                   kLeft * std::log1p(relation.left / std::max(cause.support.gain, kLeastGain)) +
                   (kBeside + (relation.common_law.empty() ? 0 : kParts)) * std::log(named);
  if (relation.has_remainder) against += kRemainder;
  if (relation.outcome == Outcome::Unknown) against += kUnknown;
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

double supported_share(double confidence) {
  const auto* const row =
      std::find_if(std::begin(kReliability), std::prev(std::end(kReliability)),
                   [&](const Reliability& one) { return confidence >= one.from; });
  return static_cast<double>(row->right) / row->names;
}

std::string frequency_of(double share) {
  constexpr double kNearlyAlways = 0.95;
  constexpr double kOfTen = 10;
  return share >= kNearlyAlways ? "19 of 20"
                                : fmt::format("{:.0f} of 10", std::floor(kOfTen * share));
}

}  // namespace rths::diagnosis
