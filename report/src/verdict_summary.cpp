// SPDX-License-Identifier: Apache-2.0
//
// A verdict, and the plan of a diagnosis, in a few lines for a terminal.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/report/diagnosis.hpp>

#include "instants.hpp"
#include "numbers.hpp"

namespace rths::report {
namespace {

using diagnosis::Plan;

// Names of the effects, by part.
std::string search_text(const Plan::Examined& examined) {
  std::map<std::string, std::vector<std::string>> by_part;
  for (const auto& effect : examined.effects) {
    auto& names = by_part[diagnosis::name_of(effect.part)];
    if (std::ranges::find(names, effect.name) == names.end()) names.push_back(effect.name);
  }
  std::string text;
  for (auto& [part, names] : by_part) {
    std::ranges::sort(names);
    text += fmt::format("search    {}: {}\n", part, fmt::join(names, ", "));
  }
  return text;
}

std::string effect_text(const Plan::Effect& effect) {
  const std::string from =
      effect.smallest > 0
          ? fmt::format("{} {:.3g} {}", effect.smallest <= effect.size ? "from" : "up to",
                        effect.smallest, effect.unit)
          : "-";
  return fmt::format("          {:<28} {:<18} {:>10.3g} {:<10} {:>10.3g}  {}\n", effect.name,
                     effect.channel, effect.size, effect.unit, effect.information, from);
}

std::string effects_text(const Plan::Examined& examined) {
  std::string text = fmt::format("visible   {:<28} {:<18} {:>10} {:<10} {:>10}  {}\n", "effect",
                                 "at", "typical", "", "nat", "detectable");
  std::vector<std::string> unseen;
  for (const auto& effect : examined.effects) {
    if (effect.information >= diagnosis::kDetectable)
      text += effect_text(effect);
    else
      unseen.push_back(fmt::format("{} at {}", effect.name, effect.channel));
  }
  if (!unseen.empty())
    text += fmt::format("hidden    below {:g} nat at a typical size: {}\n", diagnosis::kDetectable,
                        fmt::join(unseen, ", "));
  return text;
}

std::string examined_text(const Plan::Examined& examined) {
  const std::string compared = examined.rate > 0
                                   ? fmt::format("compared at {:.4g} Hz", examined.rate)
                                   : "compared row by row";
  std::string text = fmt::format(
      "\nrelation  {}: {}, {}{}\n", examined.relation, fmt::join(examined.outputs, ", "),
      examined.cutoff > 0 ? fmt::format("below {:.3g} Hz, ", examined.cutoff) : "", compared);
  text += fmt::format(
      "cost      {:.0f} values, about {:.0f} MB; some {:.1g} s of processor time if nothing is "
      "missing, up to some {:.1g} s\n",
      examined.cost.values, examined.cost.memory * 1e-6, examined.cost.shortest,
      examined.cost.longest);
  for (const auto& visited : examined.visited) text += "visited   " + visited + "\n";
  if (!examined.fitted.empty())
    text += fmt::format("fitted    {}\n", fmt::join(examined.fitted, ", "));
  text += search_text(examined) + effects_text(examined);
  for (const auto& confusion : examined.confusions)
    text += fmt::format("confused  {} with {}: {:.1f} % of it, {:.2g} nat left\n", confusion.effect,
                        confusion.rival, confusion.share * kPercent, confusion.left);
  return text;
}

using diagnosis::Verdict;

constexpr std::size_t kMostIntervals = 4;  // shown of each kind; verdict.json has all

// Four digits, or as many as tell the ends of an interval apart.
int digits_of(const std::vector<std::pair<double, double>>& intervals) {
  constexpr int kUsual = 4;
  constexpr double kShare = 10;  // of an interval: with four digits an error of a thousandth
  int digits = kUsual;
  for (const auto& [from, to] : intervals)
    digits = std::max(digits, digits_of_instants(to, kShare * (to - from), kUsual));
  return digits;
}

std::string intervals_text(const std::vector<std::pair<double, double>>& intervals,
                           const char* unit) {
  const int digits = digits_of(intervals);
  std::string text;
  for (std::size_t i = 0; i < std::min(intervals.size(), kMostIntervals); ++i)
    text += fmt::format("{}{:.{}g} to {:.{}g}", i ? ", " : "", intervals[i].first, digits,
                        intervals[i].second, digits);
  if (text.empty()) return text;
  if (intervals.size() > kMostIntervals)
    text += fmt::format(" and {} more", intervals.size() - kMostIntervals);
  return "; " + text + " " + unit;
}

std::string where_text(const Verdict& verdict) {
  if (verdict.conclusion.where.channel.empty()) return "";
  return fmt::format("where     {}, {}{}{}\n", place_of(verdict.conclusion.where.part, verdict),
                     verdict.conclusion.where.channel,
                     intervals_text(verdict.conclusion.where.intervals,
                                    verdict.conclusion.where.has_time ? "s" : "(rows)"),
                     intervals_text(verdict.conclusion.where.bands, "Hz"));
}

std::string cause_text(const diagnosis::Cause& cause) {
  std::string text =
      fmt::format("cause     {}: {}\n          confidence {:.2f}{}\n", cause.name, cause.equation,
                  cause.confidence,
                  std::isfinite(cause.explained)
                      ? fmt::format(", explains {:.0f} %", cause.explained * kPercent)
                      : "");
  for (const auto& p : cause.parameters)
    text += fmt::format("          {:<44} {:.4g} [{:.4g}, {:.4g}] {}\n", p.name, p.value, p.low,
                        p.high, p.unit);
  for (const auto& other : cause.alternatives)
    text +=
        fmt::format("or        {} ({:.0f} % of the gain); {}\n", other.name, other.share * kPercent,
                    other.test.empty()
                        ? "no known test separates them"
                        : fmt::format("{} separates them ({:.0f} sigma)", other.test, other.sigma));
  return text;
}

std::string description_text(const Verdict& verdict) {
  if (verdict.descriptions.empty()) return "";
  const auto& best = verdict.descriptions.front();
  return fmt::format("form      {}{}, {:.0f} % of the systematic residual\n", best.form,
                     best.is_of_terms ? ", the law of the terms together" : "",
                     best.share * kPercent);
}

// Parameters fitted without and with the named causes.
std::string refitted_text(const Verdict& verdict) {
  std::string text;
  for (const auto& p : verdict.evaluation.refitted)
    text += fmt::format("fitted    {:<44} {:.4g} without, {:.4g} with the named causes {}\n",
                        p.name, p.before, p.after, p.unit);
  return text;
}

std::string percent(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g} %", value * kPercent) : "-";
}

std::string scores_text(const Verdict& verdict) {
  if (verdict.evaluation.fit.empty()) return "";
  std::size_t width = 8;
  for (const auto& score : verdict.evaluation.fit) width = std::max(width, score.record.size());
  std::string text = fmt::format("\n{:<{}}  {:<9} {:>10} {:>10} {:>10}\n", "error on", width, "",
                                 "before", "after", "noise");
  for (const auto& score : verdict.evaluation.fit)
    text += fmt::format("{:<{}}  {:<9} {:>10} {:>10} {:>10}\n", score.record, width,
                        score.record == verdict.evaluation.proof_record ? "proof" : score.use,
                        percent(score.nrmse_before), percent(score.nrmse_after),
                        percent(score.noise_floor));
  return text + fmt::format("the residual is {}\n",
                            verdict.evaluation.residual.is_white ? "white" : "not white");
}

}  // namespace

std::string plan_summary(const Plan& plan) {
  std::string text = fmt::format("case      {}, model of kind '{}'\n", plan.case_name, plan.kind);
  std::size_t width = 0;
  for (const auto& record : plan.records) width = std::max(width, record.name.size());
  for (const auto& record : plan.records)
    text += record.rate > 0
                ? fmt::format("record    {:<{}}  {:>6.4g} s at {:.5g} Hz: {}\n", record.name, width,
                              record.duration, record.rate, record.role)
                : fmt::format("record    {:<{}}  {:.0f} rows without time: {}\n", record.name,
                              width, record.duration, record.role);
  text += "noise     " + plan.noise.source + "\n";
  if (!plan.noise.remedy.empty())
    text +=
        "          without noise at rest the numbers of nat are rough, and a small effect "
        "cannot be told from noise;\n          " +
        plan.noise.remedy + "\n";
  for (const auto& limit : plan.limits) text += "limit     " + limit + "\n";
  for (const auto& examined : plan.relations) text += examined_text(examined);
  return text;
}

std::string answers_text(const Verdict& verdict) {
  const auto answers = diagnosis::answers_of(verdict);
  return fmt::format("{}\n\nmissing   {}\nsure      {}\nnow       {}", answers.headline,
                     answers.missing, answers.certainty, answers.next);
}

std::string verdict_summary(const Verdict& verdict) {
  std::string text =
      answers_text(verdict) + "\n\n" + verdict.sentence + "\n\n" + where_text(verdict);
  for (const auto& cause : verdict.conclusion.causes) text += cause_text(cause);
  text += refitted_text(verdict);
  text += description_text(verdict);
  if (!verdict.next.text.empty()) text += "next      " + verdict.next.text + "\n";
  for (const auto& limit : verdict.limits) text += "limit     " + limit + "\n";
  return text + scores_text(verdict);
}

}  // namespace rths::report
