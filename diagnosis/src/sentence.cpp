// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/sim/term.hpp>

#include "investigation.hpp"

namespace rths::diagnosis {
namespace {

std::string number(double value) { return fmt::format("{:.3g}", value); }
std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

// "platen mass 5.1e3 ± 20 kg": the first parameters of a cause, which are its sizes.
std::string sizes_of(const Cause& cause) {
  std::string text;
  for (std::size_t i = 0; i < cause.parameters.size() && i < 2; ++i) {
    const Estimate& estimate = cause.parameters[i];
    const auto dot = estimate.name.find('.');
    std::string name = estimate.name.substr(dot + 1);
    for (char& c : name)
      if (c == '_' || c == '.') c = ' ';
    const std::string unit = estimate.unit == "-" ? "" : " " + estimate.unit;
    text += fmt::format("{}{} {} ± {}{}", text.empty() ? ", " : ", ", name, number(estimate.value),
                        number((estimate.high - estimate.low) / 2), unit);
  }
  return text;
}

std::string proof_of(const Verdict& verdict) {
  for (const auto& score : verdict.fit)
    if (score.record == verdict.proof_record)
      return fmt::format("on the unseen record {} the error falls from {} to {} (floor {})",
                         score.record, percent(score.nrmse_before), percent(score.nrmse_after),
                         percent(score.noise_floor));
  return "there was no further record to prove it on";
}

}  // namespace

std::string sentence_of(const Verdict& verdict) {
  if (verdict.outcome == Outcome::None) {
    return verdict.proof_record.empty()
               ? "Nothing is missing: what remains is noise."
               : fmt::format("Nothing is missing: what remains is noise; {}.", proof_of(verdict));
  }
  std::string text;
  for (const auto& cause : verdict.causes) {
    text += fmt::format("{}{}{} ({}{})", text.empty() ? "" : " and ",
                        cause.is_rule ? "in place of the assumed rule of hysteresis " : "",
                        cause.title, name_of(cause.part), sizes_of(cause));
  }
  if (verdict.outcome == Outcome::Missing) {
    double explained = 0;
    for (const auto& cause : verdict.causes) explained = std::min(1.0, explained + cause.explained);
    std::string ties;
    for (const auto& alternative : verdict.causes[0].alternatives)
      ties += fmt::format("{}{}", ties.empty() ? " Could also be " : " or ", alternative.title);
    if (!ties.empty())
      ties += verdict.next_test.empty() ? "; no test that is known would tell."
                                        : fmt::format(". Next test: {}.", verdict.next_test);
    return fmt::format(
        "Missing: {}, confidence {:.2f}; explains {:.0f} % of what was unexplained; "
        "{}.{}{}",
        text, verdict.causes[0].confidence, 100 * explained, proof_of(verdict), ties,
        verdict.has_remainder ? " Something smaller remains that has no name." : "");
  }
  text = text.empty() ? "" : fmt::format(" besides {}", text);
  const std::string form =
      verdict.descriptions.empty()
          ? "of no form that was tried"
          : fmt::format(
                "of the form {}, which explains {:.0f} % of it on a record it was not "
                "fitted to",
                verdict.descriptions[0].form, 100 * verdict.descriptions[0].share);
  return fmt::format(
      "Unknown: something systematic is missing in {} ({}){} that no term of the catalogue "
      "explains, {}.",
      verdict.where.channel, name_of(verdict.where.part), text, form);
}

namespace {

const char* table_of(const sim::TermKind& kind) {
  return kind.stage >= sim::Stage::Motion && kind.stage <= sim::Stage::Restoring ? "specimen"
                                                                                 : "machine";
}

// "friction", or "friction.long" and "friction.lat".
bool means(const std::string& name, const sim::TermSettings& term) {
  return term.name == name || term.name.starts_with(name + ".");
}

std::string added_term(const sim::TermSettings& settings, const std::string& channel,
                       const Hypothesis& named) {
  const sim::TermKind& kind = sim::term_kind(settings.kind);
  std::string name = settings.name;
  for (char& c : name)
    if (c == '.') c = '_';
  std::string text = fmt::format("[{}.{}]\nkind = \"{}\"\n", table_of(kind), name, settings.kind);
  if (settings.axes != sim::kBothAxes)
    text += fmt::format("axes = [\"{}\"]\n", settings.axes == 1 ? "long" : "lat");
  if ((kind.traits & sim::kPerChannel) != 0) text += fmt::format("channel = \"{}\"\n", channel);
  for (const auto& parameter : kind.parameters) {
    double value = parameter.absent;
    for (const auto& [key, number] : settings.parameters)
      if (key == parameter.name) value = number;
    for (std::size_t i = 0; i < named.free.size(); ++i) {
      const std::string& free = named.free[i].name;
      const auto dot = free.rfind('.');
      if (free.substr(dot + 1) == parameter.name && means(free.substr(0, dot), settings))
        value = named.values[static_cast<Eigen::Index>(i)];
    }
    text += fmt::format("{} = {:.6g}\n", sim::parameter_key(parameter, settings.channel), value);
  }
  return text + "\n";
}

// What a term of the model is now, if that was found to be another kind.
std::string kind_of(const sim::TermSettings& settings, const Hypothesis& named) {
  for (const auto& [now, place] : named.terms)
    if (now.name == settings.name) return now.kind;
  return settings.kind;
}

// Parameters of what the model had already, as they were fitted together with what is named.
std::string fitted_terms(const Investigation& found) {
  const Hypothesis& named = found.selection.named;
  std::vector<std::pair<std::string, std::string>> tables;  // heading, lines
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const FreeParameter& free = named.free[i];
    const auto dot = free.name.rfind('.');
    const std::string term = free.name.substr(0, dot);
    if (free.is_tolerance || dot == std::string::npos) continue;
    for (const auto& [settings, component] : found.relation->base().terms) {
      if (!component.empty() || !means(term, settings)) continue;
      const sim::TermKind& kind = sim::term_kind(kind_of(settings, named));
      std::string heading = fmt::format("[{}.{}]\n", table_of(kind), term);
      if (kind.name != settings.kind) heading += fmt::format("kind = \"{}\"\n", kind.name);
      if (tables.empty() || tables.back().first != heading) tables.emplace_back(heading, "");
      for (const auto& parameter : kind.parameters)
        if (parameter.name == free.name.substr(dot + 1))
          tables.back().second +=
              fmt::format("{} = {:.6g}\n", sim::parameter_key(parameter, settings.channel),
                          named.values[static_cast<Eigen::Index>(i)]);
      break;
    }
  }
  std::string text;
  for (const auto& [heading, lines] : tables) text += heading + lines + "\n";
  return text;
}

}  // namespace

std::string fragment_of(const Investigation& found) {
  std::string text;
  for (const auto& step : found.selection.steps)
    for (const auto& [settings, component] : step.chosen.candidate.adds)
      text += added_term(settings, step.chosen.candidate.channel, found.selection.named);
  return found.is_named() ? text + fitted_terms(found) : text;
}

}  // namespace rths::diagnosis
