// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

/// Adds the gains of an investigation's candidates to a verdict, behind those of others. There is
/// room for ten.
void add_evidence(const Investigation& found, Verdict& verdict);

/// Adds the forms of an investigation's residual to a verdict, behind those of others.
void add_descriptions(const Investigation& found, Verdict& verdict);

/// Adds the other findings of an investigation to a verdict: causes, limits, scores, proof, traces.
/// Scores, refitted parameters, proof and traces replace those of others.
void report(const Investigation& found, Verdict& verdict);

/// Output of an investigation without its axis: "displacement", "force".
[[nodiscard]] std::string output_of(const Investigation& found);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence_of(const Verdict& verdict);

/// The same of a verdict whose first cause is the transfer system.
/// @param finding  about the transfer system
[[nodiscard]] std::string transfer_sentence(const Verdict& verdict, const std::string& finding);

}  // namespace rths::diagnosis
