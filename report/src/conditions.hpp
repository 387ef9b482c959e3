// SPDX-License-Identifier: Apache-2.0
//
// The conditions of a conclusive test: one function each, which returns the first break.
// docs/experiments.md states the conditions and derives their bounds.
#pragma once

#include <optional>
#include <vector>

#include "evidence.hpp"

namespace rths::report {

using Break = std::optional<Broken>;

/// The response beside its reference, in words.
[[nodiscard]] std::string proportion(const Proportion& f, const std::string& reference);
/// Delay of a response [s]; none without motion.
[[nodiscard]] std::optional<double> delay_of(const std::vector<double>& reference,
                                             const std::vector<double>& response,
                                             const Evidence& all);

/// Rows of the test, without the retreat after it.
[[nodiscard]] std::size_t test_rows(const Reader& run);

/// A trip of the safety layer, from the run's recording.
[[nodiscard]] Break safety_of(const Reader& run);
/// A node or a target that was late in the half second before a time, as a sentence; empty if none
/// was.
[[nodiscard]] std::string lateness_before(const Reader& run, double time);

// Of the signals of one axis.
[[nodiscard]] Break limit_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds);
[[nodiscard]] Break tracking_of(const AxisEvidence& axis, const Evidence& all,
                                const Bounds& bounds);
[[nodiscard]] Break offset_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds);
/// The reference of the load within the capacity of the machine.
[[nodiscard]] Break load_limit_of(const Evidence& all);
[[nodiscard]] Break load_of(const Evidence& all, const Bounds& bounds);

/// A word that another node repeats.
struct Wire {
  const RecordedSignal *from, *to;
  std::size_t latest;  ///< longest transfer [ticks]
  bool is_copy;        ///< false: a word that is held for a step
  double bound;        ///< of the difference, RMS over that of the word [-]
  double least;        ///< standard deviation of a word that is judged
};
[[nodiscard]] std::vector<Wire> wires_of(const AxisEvidence& axis, const Evidence& all,
                                         const Bounds& bounds);
[[nodiscard]] Break wire_of(const Wire& wire, const Evidence& all);

/// A feedback, the signal that it has to follow, and their scale.
struct Feedback {
  const RecordedSignal* word;
  const std::vector<double>* expected;
  double scale;  ///< of its values
  double jump;   ///< largest deviation from the neighbours, over the scale [-]
};
[[nodiscard]] std::vector<Feedback> feedbacks_of(const AxisEvidence& axis, const Bounds& bounds);
[[nodiscard]] Break live_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds);
[[nodiscard]] Break jump_of(const Feedback& feedback, const Evidence& all);
[[nodiscard]] Break noise_of(const Feedback& feedback, const Evidence& all, const Bounds& bounds);

/// Displacement and acceleration measure the same motion.
[[nodiscard]] Break motion_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds);
/// @param until  the force is judged up to this time, when the displacement becomes implausible [s]
[[nodiscard]] Break force_of(const AxisEvidence& axis, const Evidence& all, const Bounds& bounds,
                             double until);

}  // namespace rths::report
