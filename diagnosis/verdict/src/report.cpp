// SPDX-License-Identifier: Apache-2.0
#include "report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>
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

// @param reduced  models whose predictions are added
void add_traces(const Investigation& found, const Problem& problem, std::size_t record,
                const Reduced& reduced, Verdict& verdict) {
  const Drive& drive = problem.drive(record);
  const Supposition base{problem, found.selection.base}, named{problem, found.selection.named};
  const MatrixXd stated = Supposition{problem, found.relation->base()}.prediction(record);
  const MatrixXd before = base.prediction(record), after = named.prediction(record);
  if (stated.size() == 0 || before.size() == 0 || after.size() == 0) return;
  const MatrixXd excess = excess_of(base, record);
  std::vector<std::pair<std::string, MatrixXd>> without;
  for (const auto& [name, hypothesis] : reduced)
    without.emplace_back(name, Supposition{problem, hypothesis}.prediction(record));
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
    // Free offsets are no error: each curve is shifted onto the measurement.
    const auto shift = [&](const MatrixXd& prediction) {
      return found.relation->has_free_offsets()
                 ? (drive.measured.col(output) - prediction.col(output)).mean()
                 : 0.0;
    };
    const double s0 = shift(stated), s1 = shift(before), s2 = shift(after);
    for (Index row = drive.first_row; row < drive.rows(); ++row) {
      if (drive.present.size() > 0 && drive.present[row] == 0) continue;
      trace.time.push_back(drive.start + static_cast<double>(row) * drive.time_step);
      if (drive.displacement.size() > 0) trace.abscissa.push_back(drive.displacement(row, output));
      trace.measured.push_back(drive.measured(row, output));
      trace.stated.push_back(stated(row, output) + s0);
      trace.before.push_back(before(row, output) + s1);
      trace.after.push_back(after(row, output) + s2);
      trace.noise.push_back(noise(row, output));
      trace.excess.push_back(excess(row, output));
    }
    for (const auto& [name, prediction] : without) {
      if (prediction.size() == 0) continue;
      const double moved = shift(prediction);
      trace.without.push_back({name, {}});
      for (Index row = drive.first_row; row < drive.rows(); ++row)
        if (drive.present.size() == 0 || drive.present[row] != 0)
          trace.without.back().second.push_back(prediction(row, output) + moved);
    }
    if (!trace.abscissa.empty())
      trace.abscissa_label =
          fmt::format("{} [{}]", drive.state_names[k].name, drive.state_names[k].unit);
    verdict.traces.push_back(std::move(trace));
  }
}

// Error of a rival on a record of the proof, after a refit; none if it has no prediction there.
std::optional<double> error_of_rival(const Investigation& found, const Contender& rival,
                                     std::size_t record) {
  Supposition other{*found.problem, rival.fitted};
  try {
    other.set_values(other.fit(found.folds.both, 6).parameters);
    return nrmse(Supposition{*found.held_out, other.hypothesis()}, record);
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
  verdict.ablation.push_back({"without the named causes",
                              nrmse(Supposition{*found.held_out, found.selection.base}, record)});
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
        {"without " + name + " alone", nrmse(Supposition{*found.held_out, hypothesis}, last)});
}

}  // namespace

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
  add_evidence(found, verdict);
  for (const auto& description : found.descriptions) {
    constexpr double kLeastFormShare = 0.02;
    if (description.share > kLeastFormShare) verdict.descriptions.push_back(description);
  }
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
