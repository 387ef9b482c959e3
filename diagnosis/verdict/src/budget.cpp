// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/verdict/verdict.hpp>

namespace rths::diagnosis {
namespace {

constexpr const char* kTransferSystem = "transfer_system";

double unseen_error(const budget::AxisBudget& axis) {
  return std::isfinite(axis.held_out) ? axis.held_out : axis.transfer.error;
}

// Of the energy of the difference between displacement and reference: the lower of the axes.
double explained_by(const budget::MismatchBudget& found) {
  double lowest = 1;
  for (const auto& axis : found.axes)
    lowest = std::min(lowest, 1 - std::pow(unseen_error(axis) / axis.transfer.error_without, 2));
  return lowest;
}

Cause transfer_cause(const budget::MismatchBudget& found) {
  Cause cause;
  cause.name = kTransferSystem;
  cause.title = "tracking of the transfer system";
  cause.equation =
      "x' = q - l F - c F', with q from a valve of second order with dead band, driven by "
      "K (r(t - tau) - x) - kappa F";
  cause.part = Part::Actuator;
  cause.channel = "displacement";
  cause.confidence = 1;  // the lower of the axes
  for (const auto& axis : found.axes)
    cause.confidence = std::min(cause.confidence, axis.transfer.confidence);
  cause.explained = explained_by(found);
  for (const auto& axis : found.axes)
    for (const auto& p : axis.transfer.parameters)
      cause.parameters.push_back({fmt::format("{}_{}.{}", kTransferSystem, axis.name, p.name),
                                  p.unit, p.value, p.value - p.half_width, p.value + p.half_width});
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
      of_axes(found, "{}", [](const auto& axis) { return axis.name; }),
      of_axes(found, "{:.1f}", [](const auto& axis) { return 1e3 * axis.transfer.delay(); }),
      of_axes(found, "{:.2f}", [](const auto& axis) { return 1e3 * axis.transfer.dead_band; }),
      std::isfinite(found.axes[0].held_out) ? "an unseen record" : "seconds that were not fitted",
      of_axes(found, "{:.2g}", [](const auto& axis) { return 100 * unseen_error(axis); }));
}

// Errors of the actuator's relation with the transfer system in place of its terms.
void score(const budget::MismatchBudget& found, Verdict& verdict) {
  double fitted = 0, unseen = 0;
  for (const auto& axis : found.axes) {
    fitted = std::max(fitted, axis.transfer.error);
    unseen = std::max(unseen, unseen_error(axis));
  }
  for (auto& one : verdict.fit) {
    one.nrmse_after = one.use == "held_out" ? unseen : fitted;
    one.variance_after = std::nan("");
  }
  auto& proof = verdict.proof;
  proof.after = unseen;
  const double all = proof.before * proof.before - proof.floor * proof.floor;
  if (all > 0)
    proof.explained = std::clamp((proof.before * proof.before - unseen * unseen) / all, 0.0, 1.0);
  std::erase_if(verdict.traces,
                [](const Trace& trace) { return trace.channel.starts_with("displacement"); });
  verdict.residual_correlation.clear();
}

// The residual of the actuator has a cause now.
void name_transfer_system(Verdict& verdict) {
  std::erase_if(verdict.causes, [](const Cause& cause) { return cause.part == Part::Actuator; });
  if (verdict.causes.empty()) {
    verdict.fragment.clear();
    verdict.improved.file = {};
    verdict.refitted.clear();
    verdict.ablation.clear();
  }
  score(verdict.budget, verdict);
  verdict.causes.insert(verdict.causes.begin(), transfer_cause(verdict.budget));
  verdict.outcome = Outcome::Missing;
  verdict.descriptions.clear();
  verdict.has_remainder = false;
  verdict.confidence = 1;
  for (const auto& cause : verdict.causes)
    verdict.confidence = std::min(verdict.confidence, cause.confidence);
  verdict.sentence = fmt::format("Missing: tracking of the transfer system (actuator): {}.",
                                 transfer_text(verdict.budget));
}

}  // namespace

void add_budget(budget::MismatchBudget found, Verdict& verdict) {
  verdict.budget = std::move(found);
  if (verdict.budget.is_empty()) return;
  if (verdict.outcome == Outcome::Unknown && verdict.where.part == Part::Actuator &&
      budget::is_tracking_identified(verdict.budget))
    name_transfer_system(verdict);
  verdict.sentence += " " + budget::sentence_of(verdict.budget);
}

}  // namespace rths::diagnosis
