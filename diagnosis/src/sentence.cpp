// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include <rths/sim/term.hpp>

#include "investigation.hpp"

namespace rths::diagnosis {
namespace {

std::string number(double value) { return fmt::format("{:.3g}", value); }
std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

// ", platen mass 5.1e3 ± 20 kg": the first two parameters of a cause, which are its sizes.
std::string sizes_of(const Cause& cause) {
  std::string text;
  for (std::size_t i = 0; i < cause.parameters.size() && i < 2; ++i) {
    const Estimate& estimate = cause.parameters[i];
    const auto dot = estimate.name.find('.');
    std::string name = estimate.name.substr(dot + 1);
    for (char& c : name)
      if (c == '_' || c == '.') c = ' ';
    const std::string unit = estimate.unit == "-" ? "" : " " + estimate.unit;
    text += fmt::format(", {} {} ± {}{}", name, number(estimate.value),
                        number((estimate.high - estimate.low) / 2), unit);
  }
  return text;
}

std::string proof_of(const Verdict& verdict) {
  for (const auto& score : verdict.fit)
    if (score.record == verdict.proof_record)
      return fmt::format("on the unseen record {} the error falls from {} to {} (noise floor {})",
                         score.record, percent(score.nrmse_before), percent(score.nrmse_after),
                         percent(score.noise_floor));
  return "no record was held out to prove it";
}

// "friction (machine, …) and a different hysteresis rule: … (bearing, …)"
std::string list_of(const std::vector<Cause>& causes) {
  std::string text;
  for (const auto& cause : causes)
    text += fmt::format("{}{}{} ({}{})", text.empty() ? "" : " and ",
                        cause.is_rule ? "a different hysteresis rule: " : "", cause.title,
                        name_of(cause.part), sizes_of(cause));
  return text;
}

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[0])));
  return text;
}

// " Could also be viscous friction or quadratic drag."; with several causes, it starts with the
// cause.
std::string alternatives_of(const Cause& cause, bool is_only) {
  std::string text;
  for (const auto& alternative : cause.alternatives)
    text += fmt::format("{}{}", text.empty() ? "" : " or ", alternative.title);
  if (text.empty()) return text;
  return is_only ? fmt::format(" Could also be {}.", text)
                 : fmt::format(" {} could also be {}.", capitalised(cause.title), text);
}

// The alternatives of every cause, and the next test.
std::string ties_of(const Verdict& verdict) {
  std::string ties;
  for (const auto& cause : verdict.causes)
    ties += alternatives_of(cause, verdict.causes.size() == 1);
  if (ties.empty()) return ties;
  return ties + (verdict.next_test.empty() ? " No known test separates them."
                                           : fmt::format(" Next test: {}.", verdict.next_test));
}

std::string none_sentence(const Verdict& verdict) {
  return verdict.proof_record.empty()
             ? "Nothing is missing: the residual is noise."
             : fmt::format("Nothing is missing: the residual is noise; {}.", proof_of(verdict));
}

// The force is predicted from the measured motion, so errors of the motion remain outside.
std::string of_force(const Verdict& verdict) {
  return verdict.where.channel.starts_with("force") ? " of the force under the measured motion"
                                                    : "";
}

std::string missing_sentence(const Verdict& verdict) {
  double explained = 0;
  for (const auto& cause : verdict.causes) explained = std::min(1.0, explained + cause.explained);
  return fmt::format(
      "Missing: {}, confidence {:.2f}; explains {:.0f} % of the systematic residual{}; {}.{}{}",
      list_of(verdict.causes), verdict.confidence, 100 * explained, of_force(verdict),
      proof_of(verdict), ties_of(verdict),
      verdict.has_remainder ? " A smaller systematic residual remains unexplained." : "");
}

std::string unknown_sentence(const Verdict& verdict) {
  const std::string besides =
      verdict.causes.empty() ? "" : fmt::format("besides {}, ", list_of(verdict.causes));
  const std::string form =
      verdict.descriptions.empty()
          ? "none of the tried forms describes it"
          : fmt::format(
                "its best form is {}, which explains {:.0f} % of it on a record that it was not "
                "fitted to",
                verdict.descriptions[0].form, 100 * verdict.descriptions[0].share);
  return fmt::format(
      "Unknown: {}the residual of {} ({}) is systematic, and no term of the catalogue explains it; "
      "{}.",
      besides, verdict.where.channel, name_of(verdict.where.part), form);
}

}  // namespace

std::string sentence_of(const Verdict& verdict) {
  if (verdict.outcome == Outcome::None) return none_sentence(verdict);
  return verdict.outcome == Outcome::Missing ? missing_sentence(verdict)
                                             : unknown_sentence(verdict);
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

// Value of a parameter of an added term: fitted, else stated, else that of an absent effect.
double value_of(const sim::Parameter& parameter, const sim::TermSettings& settings,
                const Hypothesis& named) {
  double value = parameter.absent;
  for (const auto& [key, number] : settings.parameters)
    if (key == parameter.name) value = number;
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const std::string& free = named.free[i].name;
    const auto dot = free.rfind('.');
    if (free.substr(dot + 1) == parameter.name && means(free.substr(0, dot), settings))
      value = named.values[static_cast<Eigen::Index>(i)];
  }
  return value;
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
  for (const auto& parameter : kind.parameters)
    text += fmt::format("{} = {:.6g}\n", sim::parameter_key(parameter, settings.channel),
                        value_of(parameter, settings, named));
  return text + "\n";
}

// The kind of a term of the model, or the kind that a named candidate has replaced it by.
std::string kind_of(const sim::TermSettings& settings, const Hypothesis& named) {
  for (const auto& [now, place] : named.terms)
    if (now.name == settings.name) return now.kind;
  return settings.kind;
}

// The term of the base to which a free parameter belongs; null if it belongs to a component.
const sim::TermSettings* base_term(const Investigation& found, const std::string& name) {
  for (const auto& [settings, component] : found.relation->base().terms)
    if (component.empty() && means(name, settings)) return &settings;
  return nullptr;
}

// "stiffness_N_per_m = 2.1e5", or nothing if the kind has no such parameter.
std::string line_of(const sim::TermKind& kind, const std::string& parameter_name,
                    sim::Channel channel, double value) {
  std::string lines;
  for (const auto& parameter : kind.parameters)
    if (parameter.name == parameter_name)
      lines += fmt::format("{} = {:.6g}\n", sim::parameter_key(parameter, channel), value);
  return lines;
}

// Parameters of the model's own terms, as fitted together with the named terms.
std::string fitted_terms(const Investigation& found) {
  const Hypothesis& named = found.selection.named;
  std::vector<std::pair<std::string, std::string>> tables;  // heading, lines
  for (std::size_t i = 0; i < named.free.size(); ++i) {
    const FreeParameter& free = named.free[i];
    const auto dot = free.name.rfind('.');
    const std::string term = free.name.substr(0, dot);
    if (free.is_tolerance || dot == std::string::npos) continue;
    const sim::TermSettings* settings = base_term(found, term);
    if (settings == nullptr) continue;
    const sim::TermKind& kind = sim::term_kind(kind_of(*settings, named));
    std::string heading = fmt::format("[{}.{}]\n", table_of(kind), term);
    if (kind.name != settings->kind) heading += fmt::format("kind = \"{}\"\n", kind.name);
    if (tables.empty() || tables.back().first != heading) tables.emplace_back(heading, "");
    tables.back().second += line_of(kind, free.name.substr(dot + 1), settings->channel,
                                    named.values[static_cast<Eigen::Index>(i)]);
  }
  std::string text;
  for (const auto& [heading, lines] : tables) text += heading + lines + "\n";
  return text;
}

}  // namespace

std::string fragment_of(const Investigation& found) {
  std::string text;
  for (const auto& round : found.selection.rounds)
    for (const auto& [settings, component] : round.chosen.candidate.adds)
      text += added_term(settings, round.chosen.candidate.channel, found.selection.named);
  return found.is_named() ? text + fitted_terms(found) : text;
}

}  // namespace rths::diagnosis
