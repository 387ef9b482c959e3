// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/investigation.hpp>
#include <rths/identification/scores.hpp>

#include "where.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostEvidence = 10;

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
  // Tied candidates share the confidence, whatever their order.
  cause.confidence =
      std::max(round.chosen.confidence, 1 / (1 + static_cast<double>(round.tied.size())));
  for (const auto& tied : round.tied)
    cause.alternatives.push_back({tied.candidate.name, tied.candidate.title,
                                  tied.gain / std::max(round.chosen.gain, 1e-300), "", 0});
  if (round.tied.empty()) cause.confidence = std::max(cause.confidence, 0.99);
  cause.explained = explained;
  for (const auto& wanted : candidate.frees)
    for (const auto& estimate : estimates)
      if (estimate.name == wanted.name) cause.parameters.push_back(estimate);
  return cause;
}

std::vector<Refitted> refitted_of(const Investigation& found) {
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

// The final model without one of its causes, fitted again; by the name of the cause.
using Reduced = std::vector<std::pair<std::string, Hypothesis>>;
Reduced reduced_models(const Investigation& found) {
  constexpr int kIterations = 8;
  const auto& rounds = found.selection.rounds;
  Reduced reduced;
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

// Predictions of the models of an investigation for a record: as stated, before and after the named
// terms, and without each of them.
struct Predictions {
  MatrixXd stated, before, after;
  std::vector<std::pair<std::string, MatrixXd>> without;
};

// Free offsets are no error: each curve is shifted onto the measurement.
double shift_of(const Investigation& found, const Drive& drive, const MatrixXd& prediction,
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
  const Eigen::ArrayXd is_compared = drive.compared();
  for (Index row = 0; row < drive.rows(); ++row)
    if (is_compared[row] != 0)
      trace.time.push_back(drive.start + static_cast<double>(row) * drive.time_step);
  if (drive.displacement.size() == 0 || trace.time.empty()) return;
  trace.abscissa = compared_rows(drive, drive.displacement, output);
  const auto& state = drive.state_names[static_cast<std::size_t>(output)];
  trace.abscissa_label = fmt::format("{} [{}]", state.name, state.unit);
}

void add_curves(const Investigation& found, const Drive& drive, const Predictions& predictions,
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
void add_traces(const Investigation& found, const Problem& problem, std::size_t record,
                const Reduced& reduced, Verdict& verdict) {
  const auto predicted = [&](const Hypothesis& hypothesis) {
    return Supposition{problem, hypothesis}.prediction(record);
  };
  const Supposition base{problem, found.selection.base};
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
    verdict.traces.push_back(std::move(trace));
  }
}

double held_out_error(const Investigation& found, const Hypothesis& hypothesis,
                      std::size_t record) {
  const Zeros zeros = zeros_of({*found.held_out, found.selection.named});
  return nrmse({*found.held_out, hypothesis}, record, zeros);
}

// Error of a rival on a record of the proof, after a refit; none if it has no prediction there.
std::optional<double> error_of_rival(const Investigation& found, const Contender& rival,
                                     std::size_t record) {
  Supposition other{*found.problem, rival.fitted};
  try {
    other.set_values(other.fit(found.folds.both, 6).parameters);
    return held_out_error(found, other.hypothesis(), record);
  } catch (const Error&) {
    return std::nullopt;
  }
}

// Adds the errors on the record of the proof if the answer is changed and everything is refitted.
void ablate(const Investigation& found, std::size_t record, Verdict& verdict) {
  const SelectionRound& first = found.selection.rounds[0];
  const Contender* rival = !first.tied.empty()     ? &first.tied[0]
                           : !first.others.empty() ? &first.others[0]
                                                   : nullptr;
  const auto error = rival != nullptr ? error_of_rival(found, *rival, record) : std::nullopt;
  if (error)
    verdict.ablation.push_back(
        {fmt::format("{} instead of {}", rival->candidate.name, first.chosen.candidate.name),
         *error});
  verdict.ablation.push_back(
      {"without the named causes", held_out_error(found, found.selection.base, record)});
}

void add_proof(const Investigation& found, const Reduced& reduced, Verdict& verdict) {
  const Proof& proof = found.proof;
  verdict.proof = {proof.before,      proof.after,           proof.floor,
                   proof.explained(), proof.is_systematic(), found.problem->has_colour()};
  verdict.residual_correlation = proof.whiteness.correlation;
  verdict.correlation_bound = proof.whiteness.bound;
  verdict.residual_white = proof.is_white;
  if (!proof.is_held_out) return;
  verdict.proof_record = proof.records.back().record;
  verdict.fit.insert(verdict.fit.end(), proof.records.begin(), proof.records.end());
  const std::size_t last = found.held_out->records() - 1;
  for (std::size_t i = 0; i <= last; ++i)
    add_traces(found, *found.held_out, i, i == last ? reduced : Reduced{}, verdict);
  if (found.is_named()) ablate(found, last, verdict);
  for (const auto& [name, hypothesis] : reduced)
    verdict.ablation.push_back(
        {"without " + name + " alone", held_out_error(found, hypothesis, last)});
}

}  // namespace

void add_evidence(const Investigation& found, Verdict& verdict) {
  const double n = observations(*found.problem, found.folds.both);
  const auto add = [&](const Contender& contender) {
    if (verdict.evidence.size() >= kMostEvidence || contender.gain <= 0) return;
    verdict.evidence.push_back({contender.candidate.name, contender.candidate.title,
                                contender.gain / n, contender.low / n, contender.high / n});
  };
  const Selection& selection = found.selection;
  std::vector<Contender> all = selection.rounds.empty() ? selection.last : selection.first;
  std::stable_sort(all.begin(), all.end(),
                   [](const Contender& a, const Contender& b) { return a.gain > b.gain; });
  for (const auto& contender : all) add(contender);
}

std::string output_of(const Investigation& found) {
  return family_of(found.relation->outputs()[0].first);
}

void add_descriptions(const Investigation& found, Verdict& verdict) {
  for (const auto& description : found.descriptions) {
    if (description.share <= kLeastShareOfForm) continue;
    verdict.descriptions.push_back(description);
    verdict.descriptions.back().channel = output_of(found);
  }
}

void report(const Investigation& found, Verdict& verdict) {
  const Selection& selection = found.selection;
  double total = 0;
  for (const auto& round : selection.rounds) total += std::max(0.0, round.chosen.gain);
  const auto estimates =
      found.is_named()
          ? estimates_of(
                selection.named,
                covariance_of(*found.problem, found.folds.both, selection.named,
                              fold_disagreement(*found.problem, found.folds, selection.named)))
          : std::vector<Estimate>{};
  for (const auto& round : selection.rounds)
    verdict.causes.push_back(cause_of(
        round, estimates,
        found.proof.explained() * std::max(0.0, round.chosen.gain) / std::max(total, 1e-300)));
  for (const auto& [candidate, reason] : found.withdrawn)
    verdict.limits.push_back(
        fmt::format("{} was selected and is not named: {}.", candidate.title, reason));
  verdict.has_remainder = verdict.has_remainder || found.has_remainder();
  verdict.refitted = refitted_of(found);
  verdict.fit = scores_of(*found.problem, selection, false);
  verdict.traces.clear();
  const Reduced reduced = reduced_models(found);
  for (std::size_t i = 0; i < found.problem->records(); ++i)
    add_traces(found, *found.problem, i, i == 0 ? reduced : Reduced{}, verdict);
  add_proof(found, reduced, verdict);
}

}  // namespace rths::diagnosis
