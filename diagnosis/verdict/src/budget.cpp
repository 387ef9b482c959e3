// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include <rths/identification/constants.hpp>
#include <rths/sim/composition.hpp>
#include <rths/verdict/verdict.hpp>

#include "confidence.hpp"
#include "report.hpp"

namespace rths::diagnosis {
namespace {

constexpr const char* kTransferSystem = "transfer_system";

constexpr const char* kDisplacement = "displacement";

/// Errors of an axis on the record of the proof [-].
struct AxisErrors {
  double before = 0;  ///< of a displacement equal to the reference
  double after = 0;   ///< of the transfer system
  double noise = 0;

  /// Of the energy of the error beyond the noise.
  [[nodiscard]] double explained() const {
    const double all = before * before - noise * noise;
    return all > 0 ? std::clamp((before * before - after * after) / all, 0.0, 1.0) : 0;
  }
};

AxisErrors fitted_errors(const budget::AxisBudget& axis) {
  return {axis.transfer.error_without, axis.transfer.error, axis.noise};
}

AxisErrors unseen_errors(const budget::AxisBudget& axis) {
  AxisErrors errors = fitted_errors(axis);
  if (std::isfinite(axis.held_out)) errors.after = axis.held_out;
  if (std::isfinite(axis.held_out_without)) errors.before = axis.held_out_without;
  return errors;
}

// Of the axis that is explained least.
template <class Errors>
AxisErrors worst(const budget::MismatchBudget& found, Errors errors) {
  AxisErrors worst = errors(found.axes[0]);
  for (const auto& axis : found.axes)
    if (const AxisErrors one = errors(axis); one.explained() < worst.explained()) worst = one;
  return worst;
}

Cause transfer_cause(const budget::MismatchBudget& found) {
  Cause cause;
  cause.name = kTransferSystem;
  cause.title = "tracking of the transfer system";
  cause.equation =
      "x' = q - l F - c F', with q from a valve of second order with dead band, driven by "
      "K (r(t - tau) - x) - kappa F";
  cause.part = Part::Actuator;
  cause.channel = kDisplacement;
  cause.confidence = kMostSure;  // the lower of the axes
  for (const auto& axis : found.axes)
    cause.confidence = std::min(cause.confidence, axis.transfer.confidence);
  cause.explained = worst(found, unseen_errors).explained();
  for (const auto& axis : found.axes)
    for (const auto& p : axis.transfer.parameters)
      cause.parameters.push_back(
          {fmt::format("{}_{}.{}", kTransferSystem, name_of(axis.axis), p.name), p.unit, p.value,
           p.value - p.half_width, p.value + p.half_width});
  return cause;
}

template <class Value>
std::string of_axes(const budget::MismatchBudget& found, const char* form, Value value) {
  std::string text;
  for (const auto& axis : found.axes)
    text += (text.empty() ? "" : " and ") + fmt::format(fmt::runtime(form), value(axis));
  return text;
}

std::string transfer_text(const budget::MismatchBudget& found) {
  return fmt::format(
      "the displacement differs from its command by {} % rms ({}); identified with a delay of {} "
      "ms before compensation and a dead band of {} mm, it predicts the displacement of {} to {} %",
      of_axes(found, "{:.3g}", [](const auto& axis) { return 100 * axis.tracking; }),
      of_axes(found, "{}", [](const auto& axis) { return name_of(axis.axis); }),
      of_axes(found, "{:.1f}", [](const auto& axis) { return 1e3 * axis.transfer.delay(); }),
      of_axes(found, "{:.2f}", [](const auto& axis) { return 1e3 * axis.transfer.dead_band; }),
      std::isfinite(found.axes[0].held_out) ? "an unseen record" : "seconds that were not fitted",
      of_axes(found, "{:.2g}", [](const auto& axis) { return 100 * unseen_errors(axis).after; }));
}

// Errors of the actuator's relation with the transfer system in place of its terms, all of them of
// unfiltered signals.
void score(const budget::MismatchBudget& found, Evaluation& evaluation) {
  for (auto& one : evaluation.fit) {
    const AxisErrors errors = worst(found, one.use == "held_out" ? unseen_errors : fitted_errors);
    one.nrmse_stated = std::nan("");
    one.nrmse_before = errors.before;
    one.nrmse_after = errors.after;
    one.noise_floor = errors.noise;
    one.variance_before = one.variance_after = std::nan("");
  }
  const AxisErrors unseen = worst(found, unseen_errors);
  auto& proof = evaluation.proof;
  proof.before = unseen.before;
  proof.after = unseen.after;
  proof.floor = unseen.noise;
  proof.explained = unseen.explained();
  std::erase_if(evaluation.traces,
                [](const Trace& trace) { return trace.channel.starts_with(kDisplacement); });
  evaluation.residual.correlation.clear();
  evaluation.refitted.clear();
}

// Removes a term from the model of an improved case, and its parameters from the fitted ones.
void remove_term(const std::string& term, Config& model) {
  const auto is_of_term = [&](const std::string& name) { return name.starts_with(term + "."); };
  model = model.without(term);
  auto fitted = model.texts("fitted", {});
  std::erase_if(fitted, is_of_term);
  if (model.has("fitted")) model.put("fitted", fitted);
  Config bounds = model.table_or_empty("bounds");
  for (const auto& name : bounds.keys())
    if (is_of_term(name)) bounds = bounds.without(name);
  if (model.has("bounds")) model.set("bounds", bounds);
}

// The term of the actuator that a table of the fragment adds; empty if it adds none.
std::string added_actuator_term(const std::string& table) {
  const Config machine = Config::parse(table, "improved.toml").table_or_empty("machine");
  for (const auto& name : machine.keys())
    if (const std::string kind = machine.table(name).text("kind", "");
        !kind.empty() && sim::term_kind(kind).stage == sim::Stage::Actuator)
      return name;
  return "";
}

// Withdraws the terms of the actuator from the improved models.
// @param has_causes  others are named
void withdraw_actuator_terms(ImprovedModel& improvement, bool has_causes) {
  Config& file = improvement.source.file;
  if (!has_causes) {
    improvement.fragment.clear();
    file = {};
    return;
  }
  const std::string fragment = std::exchange(improvement.fragment, {});
  for (std::size_t begin = 0; begin < fragment.size();) {
    const auto next = fragment.find("\n[", begin);
    const auto end = next == std::string::npos ? fragment.size() : next + 1;
    const std::string table = fragment.substr(begin, end - begin);
    const std::string term = added_actuator_term(table);
    if (term.empty()) improvement.fragment += table;
    if (!term.empty() && file.has("model")) {
      Config model = file.table("model");
      remove_term(term, model);
      file.set("model", model);
    }
    begin = end;
  }
}

// The residual of the actuator has a cause now.
void name_transfer_system(Verdict& verdict) {
  Conclusion& conclusion = verdict.conclusion;
  std::erase_if(conclusion.causes, [](const Cause& cause) { return cause.part == Part::Actuator; });
  withdraw_actuator_terms(verdict.improvement, !conclusion.causes.empty());
  score(verdict.budget, verdict.evaluation);
  verdict.ablation.clear();
  std::erase_if(verdict.descriptions, [](const Description& one) {
    return one.channel.empty() || one.channel == kDisplacement;
  });
  conclusion.causes.insert(conclusion.causes.begin(), transfer_cause(verdict.budget));
  conclusion.outcome = Outcome::Missing;
  std::erase(conclusion.unexplained, kDisplacement);
  conclusion.has_remainder = !conclusion.unexplained.empty();
  doubt_guesses(conclusion);
  conclusion.confidence = confidence_in_outcome(conclusion, true);
  verdict.sentence = transfer_sentence(verdict, transfer_text(verdict.budget));
}

}  // namespace

void add_budget(budget::MismatchBudget found, Verdict& verdict) {
  verdict.budget = std::move(found);
  if (verdict.budget.is_empty()) return;
  if (verdict.conclusion.outcome == Outcome::Unknown &&
      verdict.conclusion.where.part == Part::Actuator &&
      budget::is_tracking_identified(verdict.budget))
    name_transfer_system(verdict);
  verdict.sentence += " " + budget::sentence_of(verdict.budget);
}

}  // namespace rths::diagnosis
