// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/relation_findings.hpp>

#include <algorithm>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>

#include <rths/identification/constants.hpp>
#include <rths/identification/forms.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/scores.hpp>

#include "named_model.hpp"

namespace rths::diagnosis {
namespace {

// Whether a sensor of the outputs has a sine at rest, which is an effect and no noise.
bool has_line(const Relation& relation, const SensorNoise& noise) {
  const auto& outputs = relation.outputs();
  return std::any_of(outputs.begin(), outputs.end(), [&](const auto& output) {
    return std::any_of(noise.lines().begin(), noise.lines().end(), [&](const std::string& line) {
      return line.starts_with(output.first + " ");
    });
  });
}

// Whether a form, and not only part of it, describes what remains.
bool has_form(const RelationFindings& found) {
  return !found.descriptions.empty() && found.descriptions[0].share > kHasForm;
}

// The largest variance of the whitened residual of a single record.
double largest_variance(const RelationFindings& found) {
  const TestedHypothesis named{*found.problem, found.selection.named};
  double largest = found.proof.variance();
  for (std::size_t i = 0; i < found.problem->records(); ++i)
    largest = std::max(largest, named.variance(compared(*found.problem, {i})));
  return largest;
}

// Of terms beside which others have been withdrawn.
void renew_ties(RelationFindings& found) {
  if (found.withdrawn.empty() || !found.is_named()) return;
  std::vector<Candidate> withdrawn;
  for (const auto& one : found.withdrawn) withdrawn.push_back(one.candidate);
  renew_ties(*found.problem, found.folds, found.seed, withdrawn, found.selection);
}

// The proof of the named model on the held-out records, and the form of what remains.
void prove(RelationFindings& found, DiagnosisProgress& progress) {
  progress.begin_stage("proof");
  if (found.held_out) found.held_out->renew_noise(found.selection.named);
  found.proof = found.held_out ? proof_of(*found.held_out, found.selection, true)
                               : proof_of(*found.problem, found.selection, false);
  progress.begin_stage("form of the residual");
  found.descriptions.clear();
  if (found.has_remainder())
    found.descriptions =
        describe(TestedHypothesis{*found.problem, found.selection.named}, found.folds);
}

// A parameter of the model that the sizes of a named term can replace keeps its stated value: of
// two with the same effect, the records show only the sum.
void hold_replaceable(RelationFindings& found) {
  const Hypothesis& stated = found.relation->base();
  const Index of_model = std::ssize(stated.free);  // they come first
  if (!found.is_named() || of_model == 0) return;
  Hypothesis& named = found.selection.named;
  while (true) {
    const auto all = undetermined(*found.problem, found.folds.both, named);
    if (all.empty() || all.front() >= of_model || all.back() < of_model) return;
    FreeParameter& held = named.free[static_cast<std::size_t>(all.front())];
    held.low = held.high = named.values[all.front()] = stated.values[all.front()];
    named = fitted(*found.problem, named, found.folds.both, kLongFit);
  }
}

// Whether a round named no law of displacement or velocity, but a rule, a sensor or an actuator.
bool is_no_law(const SelectionRound& round) {
  const Part part = round.chosen.candidate.part;
  return is_rule(round) || part == Part::Sensor || part == Part::Actuator;
}

// The law that several named terms draw together, at the fitted values of all others.
std::optional<Description> common_law_of(const RelationFindings& found) {
  const Selection& selection = found.selection;
  const auto& rounds = selection.rounds;
  if (std::count_if(rounds.begin(), rounds.end(), std::not_fn(is_no_law)) < 2) return std::nullopt;
  return common_law(
      {*found.problem, selection.named},
      {*found.problem, with_rounds(selection.base, rounds, is_no_law, selection.named)});
}

// Withdraws candidates until none is left to withdraw, and proves what stays after each.
template <class Withdrawal>
void withdraw_one_by_one(RelationFindings& found, DiagnosisProgress& progress,
                         const Withdrawal& withdrawal) {
  while (auto one = withdrawal()) {
    found.withdrawn.push_back(std::move(*one));
    prove(found, progress);
  }
}

// An unknown effect resembles terms of the catalogue in part. Those that leave more than half of
// the residual, in the mean of the fit and the proof, are no causes.
void withdraw_resemblances(RelationFindings& found, DiagnosisProgress& progress) {
  if (!found.is_named() || !found.is_unknown()) return;
  if (found.selection.explained() + found.proof.explained() >= 2 * kMostly) return;
  auto all = withdraw_all(*found.problem, found.folds, "most of the residual remains unknown",
                          found.selection);
  std::move(all.begin(), all.end(), std::back_inserter(found.withdrawn));
  prove(found, progress);
}

}  // namespace

bool RelationFindings::has_remainder() const {
  if (!problem->is_noise_known()) return !proof.is_white;
  const double rest = selection.variance_named - 1;
  return proof.is_systematic() || rest > std::max(0.15, 0.005 * (selection.variance_ruled - 1)) ||
         (rest > 0.05 && selection.explained() < kExplained);
}

bool RelationFindings::is_unknown() const {
  const double explained = std::min(selection.explained(), proof.explained());
  if (!has_remainder() || (is_named() && explained >= kExplained)) return false;
  if (!problem->is_noise_known()) return true;
  if (proof.is_systematic() && has_line(*relation, *noise)) return true;
  // A short rest gives the noise only roughly, and a recording code integrates in its own way. So a
  // small excess counts only if it has a form, and one that noise does not have.
  const double rest = std::min(selection.variance_named, proof.variance()) - 1;
  return rest > kPlain || largest_variance(*this) - 1 > kPlainEvent ||
         std::any_of(descriptions.begin(), descriptions.end(), [](const Description& one) {
           return one.share > kHasForm && one.over != Description::Over::Time;
         });
}

std::unique_ptr<RelationFindings> examine(std::unique_ptr<Relation> relation,
                                          const std::vector<Record>& records,
                                          const SensorNoise& noise, std::uint64_t seed,
                                          DiagnosisProgress& progress) {
  auto found = std::make_unique<RelationFindings>();
  found->relation = std::move(relation);
  found->noise = &noise;
  found->seed = seed;
  found->split = split_of(records);
  found->first = *found->split.records[0];
  progress.enter(found->relation->name());
  progress.begin_stage("noise");
  found->problem = std::make_unique<Problem>(*found->relation, found->split.records, noise, seed);
  found->problem->report_to(progress);
  found->folds = folds_of(found->split, *found->problem);
  found->selection = select(*found->problem, found->folds, seed);
  if (!found->split.held.empty())
    found->held_out =
        std::make_unique<Problem>(*found->relation, found->split.held, noise, seed + 1);
  progress.begin_stage("proof");
  found->withdrawn =
      prune(*found->problem, found->held_out.get(), found->folds, noise, found->selection);
  prove(*found, progress);
  withdraw_one_by_one(*found, progress, [&]() -> std::optional<Withdrawn> {
    if (!found->is_unknown() || !has_form(*found)) return std::nullopt;
    return withdraw_for_form(*found->problem, found->folds, found->descriptions, found->selection);
  });
  withdraw_one_by_one(*found, progress, [&]() -> std::optional<Withdrawn> {
    if (!found->is_named() || !found->has_remainder()) return std::nullopt;
    return withdraw_for_law(*found->problem, found->folds, found->selection);
  });
  withdraw_resemblances(*found, progress);
  renew_ties(*found);
  hold_replaceable(*found);
  found->common_law = common_law_of(*found);
  return found;
}

}  // namespace rths::diagnosis
