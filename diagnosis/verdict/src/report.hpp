// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {

using AllFindings = std::vector<std::unique_ptr<RelationFindings>>;

/// Gains of the candidates of some relations, those of `shown` first. There is room for ten.
[[nodiscard]] std::vector<CandidateEvidence> evidence_of(const AllFindings& all,
                                                         const RelationFindings& shown);

/// Forms of the residuals of some relations, those of `shown` first. If its residual is
/// unknown and has no form, there are none, since the first one is taken for the best of it.
[[nodiscard]] std::vector<Description> descriptions_of(const AllFindings& all,
                                                       const RelationFindings& shown);

/// The best form of what no term explains; null: none.
[[nodiscard]] const Description* form_of_rest(const Verdict& verdict);

/// Covariance of the free parameters of the named model.
[[nodiscard]] MatrixXd covariance_of(const RelationFindings& found);

/// The named terms of a relation.
/// @param covariance  of its named model
[[nodiscard]] std::vector<Cause> causes_of(const RelationFindings& found,
                                           const MatrixXd& covariance);

/// What a relation shows.
[[nodiscard]] RelationVerdict verdict_of(const RelationFindings& found);

/// Terms of a relation that were selected and are not named, and the reasons.
[[nodiscard]] std::vector<std::string> withdrawn_of(const RelationFindings& found);

/// The final model of a relation without one of its causes, fitted again; by the name of the
/// cause. Empty with fewer than two causes.
using ReducedModels = std::vector<std::pair<std::string, Hypothesis>>;
[[nodiscard]] ReducedModels reduced_models(const RelationFindings& found);

/// Scores, refitted parameters, proof and traces of a relation.
[[nodiscard]] Evaluation evaluation_of(const RelationFindings& found, const ReducedModels& reduced);

/// Errors on the record of the proof if the answer is changed and everything is refitted. Empty
/// without a held-out record.
[[nodiscard]] std::vector<Ablation> ablation_of(const RelationFindings& found,
                                                const ReducedModels& reduced);

/// Output of a relation without its axis: "displacement", "force".
[[nodiscard]] std::string output_of(const RelationFindings& found);

/// What a free-running model stands for, in a word: its inputs move it, no actuator.
inline constexpr const char* kSystem = "system";
inline constexpr const char* kStructure = "structure";

/// The text with a capital letter at its start.
[[nodiscard]] std::string capitalised(std::string text);

/// The first two parameters of a cause, which are its sizes, without those that may be absent
/// beside others.
[[nodiscard]] std::vector<Estimate> told_sizes(const Cause& cause);

/// The verdict in one sentence.
[[nodiscard]] std::string sentence_of(const Verdict& verdict);

/// The same of a verdict whose first cause is the transfer system.
/// @param finding  about the transfer system
[[nodiscard]] std::string transfer_sentence(const Verdict& verdict, const std::string& finding);

}  // namespace rths::diagnosis
