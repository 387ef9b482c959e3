// SPDX-License-Identifier: Apache-2.0
//
// The plan of a diagnosis for a terminal.
#include <algorithm>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/report/diagnosis.hpp>

#include "numbers.hpp"

namespace rths::report {
namespace {

using diagnosis::Plan;

// Names of the effects, by part.
std::string search_text(const Plan::Examined& examined) {
  std::map<std::string, std::vector<std::string>> by_part;
  for (const auto& effect : examined.effects) {
    auto& names = by_part[diagnosis::name_of(effect.part)];
    if (std::find(names.begin(), names.end(), effect.name) == names.end())
      names.push_back(effect.name);
  }
  std::string text;
  for (auto& [part, names] : by_part) {
    std::sort(names.begin(), names.end());
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
  std::string text = fmt::format(
      "\nrelation  {}: {}, {}compared at {:.4g} Hz\n", examined.relation,
      fmt::join(examined.outputs, ", "),
      examined.cutoff > 0 ? fmt::format("below {:.3g} Hz, ", examined.cutoff) : "", examined.rate);
  for (const auto& visited : examined.visited) text += "visited   " + visited + "\n";
  if (!examined.fitted.empty())
    text += fmt::format("fitted    {}\n", fmt::join(examined.fitted, ", "));
  text += search_text(examined) + effects_text(examined);
  for (const auto& confusion : examined.confusions)
    text += fmt::format("confused  {} with {}: {:.1f} % of it, {:.2g} nat left\n", confusion.effect,
                        confusion.rival, confusion.share * kPercent, confusion.left);
  return text;
}

}  // namespace

std::string plan_summary(const Plan& plan) {
  std::string text = fmt::format("case      {}, model of kind '{}'\n", plan.case_name, plan.kind);
  std::size_t width = 0;
  for (const auto& record : plan.records) width = std::max(width, record.name.size());
  for (const auto& record : plan.records)
    text += fmt::format("record    {:<{}}  {:>6.4g} s at {:.5g} Hz: {}\n", record.name, width,
                        record.duration, record.rate, record.role);
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

}  // namespace rths::report
