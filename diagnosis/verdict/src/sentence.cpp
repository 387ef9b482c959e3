// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/verdict/verdict.hpp>

#include "confidence.hpp"
#include "quantity.hpp"
#include "report.hpp"

namespace rths::diagnosis {
namespace {

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

// ", platen mass 5100 ± 20 kg"
std::string sizes_of(const Cause& cause) {
  std::string text;
  for (const auto& estimate : told_sizes(cause)) {
    std::string name = estimate.name.substr(estimate.name.find('.') + 1);
    for (char& c : name)
      if (c == '_' || c == '.') c = ' ';
    text += fmt::format(", {} {}", name, with_interval(estimate));
  }
  return text;
}

// "99.9 %", but 100 % only if nothing is left.
std::string share_text(double share) {
  constexpr double kNearlyAll = 0.9995;
  if (share < 1 && share >= kNearlyAll) return "more than 99.9 %";
  return fmt::format("{:.1f} %", 100 * share);
}

// "from 26.3 % to 0.84 %", or "at 0.84 %"
std::string course(double before, double after) {
  return percent(before) == percent(after)
             ? "at " + percent(after)
             : fmt::format("from {} to {}", percent(before), percent(after));
}

// "falls from 26.3 % to 0.84 %", or "stays at 0.84 %"
std::string change(double before, double after) {
  const char* verb = percent(before) == percent(after) ? "stays"
                     : after < before                  ? "falls"
                                                       : "rises";
  return fmt::format("{} {}", verb, course(before, after));
}

// "on the unseen record R the error falls from 26.3 % to 0.84 % (99.9 % of the unexplained energy)"
std::string errors_of(const Verdict& verdict) {
  constexpr std::size_t kMostListed = 3;
  std::vector<const RecordScore*> unseen;
  for (const auto& score : verdict.evaluation.fit)
    if (score.use == "held_out") unseen.push_back(&score);
  if (unseen.empty()) return "no record was held out to prove it";
  if (unseen.size() == 1)
    return fmt::format("on the unseen record {} the error {}", unseen[0]->record,
                       change(unseen[0]->nrmse_before, unseen[0]->nrmse_after));
  std::string each;
  if (unseen.size() <= kMostListed) {
    for (const auto* score : unseen)
      each += fmt::format("{}{} {}", each.empty() ? "" : ", ", score->record,
                          change(score->nrmse_before, score->nrmse_after));
    return "on the unseen records the error of " + each;
  }
  const auto worst = *std::max_element(
      unseen.begin(), unseen.end(),
      [](const auto* a, const auto* b) { return a->nrmse_after < b->nrmse_after; });
  return fmt::format("on {} unseen records the error {}, at worst {} ({})", unseen.size(),
                     change(verdict.evaluation.proof.before, verdict.evaluation.proof.after),
                     course(worst->nrmse_before, worst->nrmse_after), worst->record);
}

// "what is left is 31 times the sensors' noise, and systematic"
std::string rest_of(const Verdict& verdict) {
  constexpr double kNoise = 1.1;
  const ProofSummary& proof = verdict.evaluation.proof;
  const double times = proof.after / proof.floor;
  if (!proof.is_noise_known || !(times < 1e6))
    return "the sensors' noise is not known, so nothing says whether more is missing";
  const std::string noise = proof.has_noise_at_rest   ? "the sensors' noise"
                            : verdict.noise.is_stated ? "the stated noise"
                                                      : "the guessed noise";
  if (times < kNoise && !verdict.conclusion.has_remainder) return "what is left is " + noise;
  return fmt::format(
      "what is left is {:.2g} times {}{}", times, noise,
      proof.is_systematic || verdict.conclusion.has_remainder ? ", and systematic" : "");
}

// "friction (machine, …) and a different hysteresis rule: … (bearing, …)"
std::string list_of(const std::vector<Cause>& causes) {
  std::string text;
  for (const auto& cause : causes)
    text += fmt::format("{}{}{}{} ({}{})", text.empty() ? "" : " and ",
                        is_guess(cause) ? "perhaps " : "",
                        cause.is_rule ? "a different hysteresis rule: " : "", cause.title,
                        name_of(cause.part), sizes_of(cause));
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
  for (const auto& cause : verdict.conclusion.causes)
    ties += alternatives_of(cause, verdict.conclusion.causes.size() == 1);
  if (ties.empty()) return ties;
  return ties + (verdict.next.text.empty() ? " No known test separates them."
                                           : fmt::format(" Next test: {}.", verdict.next.text));
}

// The force is predicted from the measured motion, so errors of the motion remain outside.
std::string of_force(const Verdict& verdict) {
  return verdict.conclusion.where.channel.starts_with("force")
             ? " of the force under the measured motion"
             : "";
}

std::string none_sentence(const Verdict& verdict) {
  const std::string found = verdict.evaluation.proof.is_noise_known
                                ? "Nothing is missing: the residual is noise"
                                : "Nothing was found to be missing: the residual is white, but the "
                                  "sensors' noise is not known";
  return verdict.evaluation.proof_record.empty()
             ? found + "."
             : fmt::format("{}; {}.", found, errors_of(verdict));
}

// The errors of the proof, and the share of their energy that is explained.
std::string proof_of(const Verdict& verdict) {
  if (verdict.evaluation.proof_record.empty()) return errors_of(verdict);
  return fmt::format("{} ({} of the unexplained energy{}); {}", errors_of(verdict),
                     share_text(verdict.evaluation.proof.explained), of_force(verdict),
                     rest_of(verdict));
}

// "; the error of acceleration falls from 3.1 % to 0.4 %": of the relations that are not shown.
std::string others_of(const Verdict& verdict) {
  std::string text;
  for (std::size_t i = 1; i < verdict.relations.size(); ++i) {
    const RelationVerdict& relation = verdict.relations[i];
    if (relation.outcome == Outcome::None) continue;
    const std::string& role = relation.outputs[0];
    text += fmt::format("; the error of {} {}{}", role.substr(0, role.find('.')),
                        change(relation.proof.before, relation.proof.after),
                        relation.has_remainder ? ", and what is left of it is systematic" : "");
  }
  return text;
}

std::string missing_sentence(const Verdict& verdict) {
  return fmt::format("Missing: {}, confidence {:.2f}; {}{}.{}", list_of(verdict.conclusion.causes),
                     verdict.conclusion.confidence, proof_of(verdict), others_of(verdict),
                     ties_of(verdict));
}

// Empty without a form.
std::string form_text(const Verdict& verdict) {
  const Description* form = form_of_rest(verdict);
  if (form == nullptr) return "";
  const Description& best = *form;
  const char* where = best.over == Description::Over::Records ? ""
                      : best.is_of_pieces ? " on pieces of the records that it was not fitted to"
                                          : " on a record that it was not fitted to";
  return fmt::format("its best form is {}, which explains {:.0f} % of it{}", best.form,
                     100 * best.share, where);
}

// The terms explain the residual, but their names are more often wrong than right.
std::string guess_sentence(const Verdict& verdict) {
  return fmt::format(
      "Unknown: {}; {}. Such names are more often wrong than right, and only describe what is "
      "missing{}.{}",
      list_of(verdict.conclusion.causes), proof_of(verdict), others_of(verdict), ties_of(verdict));
}

std::string unknown_sentence(const Verdict& verdict) {
  const std::string besides =
      verdict.conclusion.causes.empty()
          ? ""
          : fmt::format("besides {} ({}), ", list_of(verdict.conclusion.causes), proof_of(verdict));
  const std::string form = form_text(verdict);
  return fmt::format(
      "Unknown: {}the residual of {} ({}) is systematic, and none of the terms that were searched "
      "explains it; {}{}.",
      besides, verdict.conclusion.where.channel, name_of(verdict.conclusion.where.part),
      form.empty() ? "none of the tried forms describes it" : form, others_of(verdict));
}

// " The noise was not measured at rest: …": without, a residual of wrongly estimated noise looks
// systematic.
std::string doubt_of(const Verdict& verdict) {
  const bool is_doubtful =
      verdict.conclusion.outcome == Outcome::Unknown || verdict.conclusion.has_remainder;
  if (!is_doubtful || verdict.noise.remedy.empty()) return "";
  return " The noise was not measured at rest: " + verdict.noise.remedy + ".";
}

}  // namespace

std::string capitalised(std::string text) {
  if (!text.empty()) text[0] = upper(text[0]);
  return text;
}

std::vector<Estimate> told_sizes(const Cause& cause) {
  constexpr std::size_t kMost = 2;
  std::vector<Estimate> told;
  std::copy_if(cause.parameters.begin(), cause.parameters.end(), std::back_inserter(told),
               [](const Estimate& one) {
                 return !one.absent || *one.absent < one.low || *one.absent > one.high;
               });
  if (told.empty()) told = cause.parameters;
  if (told.size() > kMost) told.resize(kMost);
  return told;
}

std::string name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::Missing:
      return "missing";
    case Outcome::None:
      return "none";
    case Outcome::Unknown:
      break;
  }
  return "unknown";
}

std::string sentence_of(const Verdict& verdict) {
  if (verdict.conclusion.outcome == Outcome::None) return none_sentence(verdict);
  const bool is_guessed =
      are_guesses(verdict.conclusion.causes) && verdict.relations[0].outcome == Outcome::Missing;
  return (verdict.conclusion.outcome == Outcome::Missing ? missing_sentence(verdict)
          : is_guessed                                   ? guess_sentence(verdict)
                                                         : unknown_sentence(verdict)) +
         doubt_of(verdict);
}

std::string transfer_sentence(const Verdict& verdict, const std::string& finding) {
  const std::vector<Cause> others{verdict.conclusion.causes.begin() + 1,
                                  verdict.conclusion.causes.end()};
  const std::string form = form_text(verdict);
  std::string rest;
  for (const auto& output : verdict.conclusion.unexplained)
    rest += fmt::format(
        "; the residual of {} is systematic, and none of the terms that were searched explains it",
        output);
  if (!form.empty()) rest += "; " + form;
  return fmt::format("Missing: {} ({}){}{}: {}{}.{}{}", verdict.conclusion.causes[0].title,
                     name_of(verdict.conclusion.causes[0].part), others.empty() ? "" : " and ",
                     list_of(others), finding, rest, ties_of(verdict), doubt_of(verdict));
}

}  // namespace rths::diagnosis
