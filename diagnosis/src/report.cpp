// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "investigation.hpp"
#include "where.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::size_t kMostEvidence = 10;
constexpr Index kMostPoints = 4000;  // of a trace

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

void add_traces(const Investigation& found, const Problem& problem, std::size_t record,
                Verdict& verdict) {
  const Drive& drive = problem.drive(record);
  const Supposition base{problem, found.selection.base}, named{problem, found.selection.named};
  const MatrixXd stated = Supposition{problem, found.relation->base()}.prediction(record);
  const MatrixXd before = base.prediction(record), after = named.prediction(record);
  if (stated.size() == 0 || before.size() == 0 || after.size() == 0) return;
  const MatrixXd excess = excess_of(base, record);
  const Index step = std::max<Index>(1, drive.rows() / kMostPoints);
  const auto& outputs = found.relation->outputs();
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    const auto output = static_cast<Index>(k);
    Trace trace;
    trace.record = problem.record(record).name;
    trace.channel = outputs[k].first;
    trace.unit = outputs[k].second;
    // Free offsets are no error: each curve is shifted onto the measurement.
    const auto shift = [&](const MatrixXd& prediction) {
      return found.relation->has_free_offsets()
                 ? (drive.measured.col(output) - prediction.col(output)).mean()
                 : 0.0;
    };
    const double s0 = shift(stated), s1 = shift(before), s2 = shift(after);
    for (Index row = 0; row < drive.rows(); row += step) {
      trace.time.push_back(drive.start + static_cast<double>(row) * drive.time_step);
      if (drive.displacement.size() > 0) trace.abscissa.push_back(drive.displacement(row, output));
      trace.measured.push_back(drive.measured(row, output));
      trace.stated.push_back(stated(row, output) + s0);
      trace.before.push_back(before(row, output) + s1);
      trace.after.push_back(after(row, output) + s2);
      trace.excess.push_back(excess(row, output));
    }
    if (!trace.abscissa.empty()) trace.abscissa_label = "displacement [m]";
    verdict.traces.push_back(std::move(trace));
  }
}

// Error of a rival on a record of the proof, after a refit; none if it has no prediction there.
std::optional<double> error_of_rival(const Investigation& found, const Contender& rival,
                                     std::size_t record) {
  Supposition other{*found.problem, rival.fitted};
  try {
    other.set_values(other.fit(found.folds.both, 6).parameters);
    return nrmse(Supposition{*found.proof, other.hypothesis()}, record);
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
      {"without the named causes", nrmse(Supposition{*found.proof, found.selection.base}, record)});
}

void prove(const Investigation& found, Verdict& verdict) {
  const Problem& problem = *found.proof;
  const std::size_t last = problem.records() - 1;
  verdict.proof_record = problem.record(last).name;
  const Supposition named{problem, found.selection.named};
  const MatrixXd white = named.whitened(last);
  constexpr Index kLags = 20;
  VectorXd correlation = VectorXd::Zero(kLags);
  double portmanteau = 0;
  const auto n = static_cast<double>(white.rows());
  for (Index output = 0; output < white.cols(); ++output) {
    const VectorXd x = white.col(output).array() - white.col(output).mean();
    const double square = std::max(x.squaredNorm(), 1e-300);
    double q = 0;
    for (Index lag = 1; lag <= kLags && lag < x.size(); ++lag) {
      const double r = x.tail(x.size() - lag).dot(x.head(x.size() - lag)) / square;
      correlation[lag - 1] += r / static_cast<double>(white.cols());
      q += n * (n + 2) * r * r / (n - static_cast<double>(lag));
    }
    portmanteau = std::max(portmanteau, q);
  }
  verdict.residual_correlation.assign(correlation.begin(), correlation.end());
  constexpr double kNormal95 = 1.96;
  verdict.correlation_bound = kNormal95 / std::sqrt(n * static_cast<double>(white.cols()));
  // Ljung & Box 1978. The colour of the noise is an estimate, so three times the quantile of 20
  // degrees of freedom is allowed.
  constexpr double kQuantile99 = 37.6, kAllowance = 3;
  verdict.residual_white = portmanteau < kAllowance * kQuantile99;
  if (found.is_named()) ablate(found, last, verdict);
}

}  // namespace

void report(const Investigation& found, Verdict& verdict) {
  const Selection& selection = found.selection;
  double total = 0;
  for (const auto& round : selection.rounds) total += std::max(0.0, round.chosen.gain);
  const auto estimates = found.is_named() ? estimates_of(found) : std::vector<Estimate>{};
  for (const auto& round : selection.rounds)
    verdict.causes.push_back(cause_of(
        round, estimates,
        selection.explained() * std::max(0.0, round.chosen.gain) / std::max(total, 1e-300)));
  add_evidence(found, verdict);
  for (const auto& description : found.descriptions) {
    constexpr double kLeastFormShare = 0.02;
    if (description.share > kLeastFormShare) verdict.descriptions.push_back(description);
  }
  verdict.has_remainder = verdict.has_remainder || selection.has_remainder();
  verdict.refitted = refitted_of(found);
  verdict.fit.clear();
  verdict.traces.clear();
  for (std::size_t i = 0; i < found.problem->records(); ++i)
    verdict.fit.push_back(score_of(found, *found.problem, i));
  add_traces(found, *found.problem, 0, verdict);
  if (found.proof == nullptr) return;
  for (std::size_t i = 0; i < found.proof->records(); ++i)
    verdict.fit.push_back(score_of(found, *found.proof, i));
  add_traces(found, *found.proof, found.proof->records() - 1, verdict);
  prove(found, verdict);
}

}  // namespace rths::diagnosis
