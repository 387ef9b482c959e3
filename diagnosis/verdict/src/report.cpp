// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/relation_findings.hpp>
#include <rths/identification/scores.hpp>

#include "confidence.hpp"
#include "where.hpp"

namespace rths::diagnosis {
namespace {

constexpr std::size_t kMostEvidence = 10;

Support support_of(const SelectionRound& round) {
  const ScoredCandidate& chosen = round.chosen;
  Support support{chosen.gain, 1, std::min(1.0, chosen.confidence)};
  // What contains the chosen one supports it.
  for (const auto& other : round.others)
    if (!contains(other.candidate.contains, chosen.candidate.name))
      support.lead = std::min(support.lead, 1 - other.gain / std::max(chosen.gain, 1e-300));
  return support;
}

Cause cause_of(const SelectionRound& round, const std::vector<Estimate>& estimates,
               double explained) {
  const Candidate& candidate = round.chosen.candidate;
  Cause cause;
  cause.name = candidate.name;
  cause.title = candidate.title;
  cause.equation = candidate.equation;
  cause.part = candidate.part;
  cause.is_rule = candidate.is_rule;
  cause.channel = candidate.channel;
  for (const auto& tied : round.tied)
    cause.alternatives.push_back({tied.candidate.name, tied.candidate.title,
                                  tied.gain / std::max(round.chosen.gain, 1e-300), "", 0});
  cause.explained = explained;
  cause.support = support_of(round);
  for (const auto& wanted : candidate.frees)
    for (const auto& estimate : estimates)
      if (estimate.name == wanted.name) {
        cause.parameters.push_back(estimate);
        cause.parameters.back().absent = wanted.absent;
      }
  return cause;
}

// Beside a remainder, the form of the model is not quite right. Intervals widen with it, and
// include what the parameters would be beside each candidate that nearly explains the remainder.
void widen_by_remainder(const RelationFindings& found, std::vector<Estimate>& estimates) {
  if (!found.has_remainder()) return;
  constexpr double kMostGrowth = 2;  // the covariance contains the remainder's variance already
  const double times = found.proof.times_noise();
  const double growth = found.problem->is_noise_known() && std::isfinite(times)
                            ? std::clamp(times, 1.0, kMostGrowth)
                            : 1;
  for (Estimate& estimate : estimates) {
    const double below = growth * (estimate.value - estimate.low);
    const double above = growth * (estimate.high - estimate.value);
    estimate.low = estimate.value - below;
    estimate.high = estimate.value + above;
    for (const ScoredCandidate& beside : found.selection.last)
      for (std::size_t i = 0; beside.gain > 0 && i < beside.fitted.free.size(); ++i) {
        if (beside.fitted.free[i].name != estimate.name) continue;
        const double value = beside.fitted.values[static_cast<Index>(i)];
        estimate.low = std::min(estimate.low, value - below);
        estimate.high = std::max(estimate.high, value + above);
      }
    for (const FreeParameter& free : found.selection.named.free)
      if (free.name == estimate.name) {
        estimate.low = std::max(estimate.low, free.low);
        estimate.high = std::min(estimate.high, free.high);
      }
  }
}

std::vector<Refitted> refitted_of(const RelationFindings& found) {
  const Hypothesis &stated = found.relation->base(), &before = found.selection.base,
                   &after = found.selection.named;
  const auto value = [](const Hypothesis& hypothesis, const std::string& name, double otherwise) {
    for (std::size_t i = 0; i < hypothesis.free.size(); ++i)
      if (hypothesis.free[i].name == name) return hypothesis.values[static_cast<Index>(i)];
    return otherwise;
  };
  std::vector<Refitted> refitted;
  for (std::size_t i = 0; i < stated.free.size(); ++i) {
    const auto& [name, unit] = std::tie(stated.free[i].name, stated.free[i].unit);
    const double was = stated.values[static_cast<Index>(i)];
    refitted.push_back({name, unit, was, value(before, name, was), value(after, name, was)});
  }
  return refitted;
}

// Predictions of the models of a relation for a record: as stated, before and after the named
// terms, and without each of them.
struct Predictions {
  MatrixXd stated, before, after;
  std::vector<std::pair<std::string, MatrixXd>> without;
};

// Free offsets are no error: each curve is shifted onto the measurement.
double shift_of(const RelationFindings& found, const Drive& drive, const MatrixXd& prediction,
                Index output) {
  return found.relation->has_free_offsets()
             ? drive.compared_rows(drive.measured - prediction).col(output).mean()
             : 0.0;
}

std::vector<double> compared_rows(const Drive& drive, const MatrixXd& values, Index output,
                                  double shift = 0) {
  const VectorXd rows = drive.compared_rows(values.col(output)).array() + shift;
  return {rows.begin(), rows.end()};
}

void add_axes_of(const Drive& drive, Index output, Trace& trace) {
  const ArrayXd is_compared = drive.compared();
  trace.has_time = drive.has_time;
  for (Index row = 0; row < drive.rows(); ++row)
    if (is_compared[row] != 0)
      trace.time.push_back(drive.start + static_cast<double>(row) * drive.time_step);
  if (drive.displacement.size() == 0 || trace.time.empty()) return;
  trace.abscissa = compared_rows(drive, drive.displacement, output);
  const auto& state = drive.state_names[static_cast<std::size_t>(output)];
  trace.abscissa_label = fmt::format("{} [{}]", state.name, state.unit);
}

void add_curves(const RelationFindings& found, const Drive& drive, const Predictions& predictions,
                Index output, Trace& trace) {
  const auto shifted = [&](const MatrixXd& prediction) {
    return compared_rows(drive, prediction, output, shift_of(found, drive, prediction, output));
  };
  trace.measured = compared_rows(drive, drive.measured, output);
  trace.stated = shifted(predictions.stated);
  trace.before = shifted(predictions.before);
  trace.after = shifted(predictions.after);
  for (const auto& [name, prediction] : predictions.without)
    if (prediction.size() > 0) trace.without.emplace_back(name, shifted(prediction));
}

// @param reduced  models whose predictions are added
void add_traces(const RelationFindings& found, const Problem& problem, std::size_t record,
                const ReducedModels& reduced, std::vector<Trace>& traces) {
  const auto predicted = [&](const Hypothesis& hypothesis) {
    return TestedHypothesis{problem, hypothesis}.prediction(record);
  };
  const TestedHypothesis base{problem, found.selection.base};
  Predictions predictions{predicted(found.relation->base()),
                          base.prediction(record),
                          predicted(found.selection.named),
                          {}};
  if (predictions.stated.size() == 0 || predictions.before.size() == 0 ||
      predictions.after.size() == 0)
    return;
  for (const auto& [name, hypothesis] : reduced)
    predictions.without.emplace_back(name, predicted(hypothesis));
  const Drive& drive = problem.drive(record);
  const MatrixXd excess = excess_of(base, record);
  const MatrixXd noise = problem.noise(record).deviation();
  const auto& outputs = found.relation->outputs();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto output = static_cast<Index>(k);
    Trace trace;
    trace.record = problem.record(record).name;
    trace.use = name_of(problem.record(record).use);
    trace.cutoff = drive.cutoff;
    trace.channel = outputs[k].first;
    trace.unit = outputs[k].second;
    add_axes_of(drive, output, trace);
    add_curves(found, drive, predictions, output, trace);
    trace.noise = compared_rows(drive, noise, output);
    trace.excess = compared_rows(drive, excess, output);
    traces.push_back(std::move(trace));
  }
}

double held_out_error(const RelationFindings& found, const Hypothesis& hypothesis,
                      std::size_t record) {
  const Zeros zeros = zeros_of({*found.held_out, found.selection.named});
  return nrmse({*found.held_out, hypothesis}, record, zeros);
}

// Error of a rival on a record of the proof, after a refit; none if it has no prediction there.
std::optional<double> error_of_rival(const RelationFindings& found, const ScoredCandidate& rival,
                                     std::size_t record) {
  TestedHypothesis other{*found.problem, rival.fitted};
  try {
    other.set_values(other.fit(found.folds.both, 6).parameters);
    return held_out_error(found, other.hypothesis(), record);
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Those of a relation, or its last round, best first.
std::vector<ScoredCandidate> ranked_of(const Selection& selection) {
  std::vector<ScoredCandidate> all = selection.rounds.empty() ? selection.last : selection.first;
  std::stable_sort(all.begin(), all.end(), [](const ScoredCandidate& a, const ScoredCandidate& b) {
    return a.gain > b.gain;
  });
  return all;
}

void add_evidence(const RelationFindings& found, std::vector<CandidateEvidence>& evidence) {
  const double n = observations(*found.problem, found.folds.both);
  for (const auto& one : ranked_of(found.selection))
    if (evidence.size() < kMostEvidence && one.gain > 0)
      evidence.push_back(
          {one.candidate.name, one.candidate.title, one.gain / n, one.low / n, one.high / n});
}

void add_descriptions(const RelationFindings& found, std::vector<Description>& descriptions) {
  for (const auto& description : found.descriptions) {
    if (description.share <= kLeastShareOfForm) continue;
    descriptions.push_back(description);
    descriptions.back().channel = output_of(found);
  }
}

// A floor of noise that is not known is no number.
void forget_floors(Evaluation& evaluation) {
  if (evaluation.proof.is_noise_known) return;
  for (auto& score : evaluation.fit) score.noise_floor = std::nan("");
}

ProofSummary summary_of(const RelationFindings& found) {
  const Proof& proof = found.proof;
  const bool is_known = found.problem->is_noise_known();
  return {proof.before,      proof.after,           is_known ? proof.floor : std::nan(""),
          proof.explained(), proof.is_systematic(), found.problem->has_colour(),
          is_known};
}

bool has_result(const RelationFindings& found) { return found.is_named() || found.is_unknown(); }

}  // namespace

std::vector<Ablation> ablation_of(const RelationFindings& found, const ReducedModels& reduced) {
  std::vector<Ablation> ablation;
  if (!found.proof.is_held_out) return ablation;
  const std::size_t last = found.held_out->records() - 1;
  if (found.is_named()) {
    const SelectionRound& first = found.selection.rounds[0];
    const ScoredCandidate* rival = !first.tied.empty()     ? &first.tied[0]
                                   : !first.others.empty() ? &first.others[0]
                                                           : nullptr;
    const auto error = rival != nullptr ? error_of_rival(found, *rival, last) : std::nullopt;
    if (error)
      ablation.push_back(
          {fmt::format("{} instead of {}", rival->candidate.name, first.chosen.candidate.name),
           *error});
    ablation.push_back(
        {"without the named causes", held_out_error(found, found.selection.base, last)});
  }
  for (const auto& [name, hypothesis] : reduced)
    ablation.push_back({"without " + name + " alone", held_out_error(found, hypothesis, last)});
  return ablation;
}

ReducedModels reduced_models(const RelationFindings& found) {
  constexpr int kIterations = 8;
  const auto& rounds = found.selection.rounds;
  ReducedModels reduced;
  if (rounds.size() < 2) return reduced;  // "before" lacks the only cause
  for (const auto& left_out : rounds) {
    Hypothesis rest = found.selection.base;
    for (const auto& round : rounds)
      if (&round != &left_out)
        rest = extended(rest, round.chosen.candidate, round.chosen.candidate.starts[0]);
    take_values(found.selection.named, rest);
    const std::string& name = left_out.chosen.candidate.name;
    if (const auto fit = fit_if_possible(*found.problem, rest, found.folds.both, kIterations)) {
      rest.values = fit->parameters;
      reduced.emplace_back(name, std::move(rest));
    }
  }
  return reduced;
}

std::string output_of(const RelationFindings& found) {
  return family_of(found.relation->outputs()[0].first);
}

std::vector<CandidateEvidence> evidence_of(const AllFindings& all, const RelationFindings& shown) {
  std::vector<CandidateEvidence> evidence;
  add_evidence(shown, evidence);
  for (const auto& found : all)
    if (found.get() != &shown && has_result(*found)) add_evidence(*found, evidence);
  return evidence;
}

std::vector<Description> descriptions_of(const AllFindings& all, const RelationFindings& shown) {
  std::vector<Description> descriptions;
  add_descriptions(shown, descriptions);
  if (shown.is_unknown() && descriptions.empty()) return descriptions;
  for (const auto& found : all)
    if (found.get() != &shown && has_result(*found)) add_descriptions(*found, descriptions);
  return descriptions;
}

const Description* form_of_rest(const Verdict& verdict) {
  const auto& all = verdict.descriptions;
  const auto best =
      std::find_if_not(all.begin(), all.end(), std::mem_fn(&Description::is_of_terms));
  return best == all.end() ? nullptr : &*best;
}

MatrixXd covariance_of(const RelationFindings& found) {
  return covariance_of(*found.problem, found.folds.both, found.selection.named,
                       fold_disagreement(*found.problem, found.folds, found.selection.named));
}

std::vector<Cause> causes_of(const RelationFindings& found, const MatrixXd& covariance) {
  std::vector<Cause> causes;
  if (!found.is_named()) return causes;
  const Selection& selection = found.selection;
  double total = 0;
  for (const auto& round : selection.rounds) total += std::max(0.0, round.chosen.gain);
  auto estimates = estimates_of(selection.named, covariance);
  widen_by_remainder(found, estimates);
  const RelationVerdict relation = verdict_of(found);
  for (const auto& round : selection.rounds) {
    const double explained =
        found.proof.explained() * std::max(0.0, round.chosen.gain) / std::max(total, 1e-300);
    causes.push_back(cause_of(round, estimates, explained));
    causes.back().confidence = confidence_in(causes.back(), relation);
  }
  return causes;
}

RelationVerdict verdict_of(const RelationFindings& found) {
  RelationVerdict verdict;
  verdict.name = found.relation->name();
  for (const auto& output : found.relation->outputs()) verdict.outputs.push_back(output.first);
  verdict.outcome = found.is_unknown() ? Outcome::Unknown
                    : found.is_named() ? Outcome::Missing
                                       : Outcome::None;
  verdict.has_remainder = found.has_remainder();
  for (const auto& round : found.selection.rounds)
    verdict.causes.push_back(round.chosen.candidate.name);
  if (found.common_law) verdict.common_law = found.common_law->form;
  verdict.is_held_out = found.proof.is_held_out;
  verdict.left = 0.5 * observations(*found.problem, found.folds.both) *
                 std::max(0.0, found.selection.variance_named - 1);
  verdict.proof = summary_of(found);
  return verdict;
}

std::vector<std::string> withdrawn_of(const RelationFindings& found) {
  std::vector<std::string> withdrawn;
  for (const auto& [candidate, reason] : found.withdrawn)
    withdrawn.push_back(
        fmt::format("{} was selected and is not named: {}.", candidate.title, reason));
  return withdrawn;
}

Evaluation evaluation_of(const RelationFindings& found, const ReducedModels& reduced) {
  const Proof& proof = found.proof;
  Evaluation evaluation;
  evaluation.refitted = refitted_of(found);
  evaluation.fit = scores_of(*found.problem, found.selection, false);
  evaluation.proof = summary_of(found);
  evaluation.residual = {proof.whiteness.correlation, proof.whiteness.bound, proof.is_white};
  if (proof.is_held_out) {
    evaluation.proof_record = proof.records.back().record;
    evaluation.fit.insert(evaluation.fit.end(), proof.records.begin(), proof.records.end());
  }
  forget_floors(evaluation);
  for (std::size_t i = 0; i < found.problem->records(); ++i)
    add_traces(found, *found.problem, i, i == 0 ? reduced : ReducedModels{}, evaluation.traces);
  if (!proof.is_held_out) return evaluation;
  const std::size_t last = found.held_out->records() - 1;
  for (std::size_t i = 0; i <= last; ++i)
    add_traces(found, *found.held_out, i, i == last ? reduced : ReducedModels{}, evaluation.traces);
  return evaluation;
}

}  // namespace rths::diagnosis
