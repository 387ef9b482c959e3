// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

/// Adds the findings of an investigation to a verdict: causes, scores, evidence, proof, traces.
void report(const Investigation& found, Verdict& verdict);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence_of(const Verdict& verdict);

}  // namespace rths::diagnosis
