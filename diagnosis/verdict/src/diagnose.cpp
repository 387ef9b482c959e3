// SPDX-License-Identifier: Apache-2.0
#include <rths/verdict/diagnose.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <set>

#include <fmt/format.h>

#include <rths/core/contains.hpp>
#include <rths/experiment_design/next_test.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/investigation.hpp>
#include <rths/identification/lattice.hpp>
#include <rths/models/barred.hpp>
#include <rths/models/relations.hpp>
#include <rths/sim/term.hpp>

#include "accelerometer_correction.hpp"
#include "check_records.hpp"
#include "improved.hpp"
#include "limits.hpp"
#include "relations_of_case.hpp"
#include "report.hpp"
#include "where.hpp"

namespace rths::diagnosis {
namespace {

using Investigations = std::vector<std::unique_ptr<Investigation>>;

std::string quantisation_of(const Lattice& lattice) {
  return family_of(lattice.role) + "_quantisation";
}

void add_lattices(const std::vector<Lattice>& lattices, Verdict& verdict) {
  for (const auto& lattice : lattices) {
    const std::string family = family_of(lattice.role);
    const std::string name = quantisation_of(lattice);
    const auto known = std::find_if(verdict.causes.begin(), verdict.causes.end(),
                                    [&](const Cause& cause) { return cause.name == name; });
    const double half = kNormal95 * lattice.deviation;
    const Estimate step{lattice.role + ".step", lattice.unit, lattice.step, lattice.step - half,
                        lattice.step + half};
    if (known != verdict.causes.end()) {
      known->parameters.push_back(step);
      continue;
    }
    Cause cause;
    cause.name = name;
    cause.title = "coarse steps of the " + family + " sensor";
    cause.equation = sim::term_kind("quantisation").equation;
    cause.part = Part::Sensor;
    cause.channel = family;
    cause.confidence = lattice.on_steps;
    cause.explained = std::nan("");
    cause.parameters = {step};
    verdict.causes.push_back(std::move(cause));
  }
}

// Number of causes: one for each family of channels.
std::size_t lattices_named(const std::vector<Lattice>& lattices) {
  std::set<std::string> families;
  for (const auto& lattice : lattices) families.insert(family_of(lattice.role));
  return families.size();
}

// An investigation that found a cause and leaves nothing unknown.
bool is_explained(const Investigation& found) { return found.is_named() && !found.is_unknown(); }

template <class Condition>
const Investigation* first_where(const Investigations& all, const Condition& holds) {
  const auto first =
      std::find_if(all.begin(), all.end(), [&](const auto& found) { return holds(*found); });
  return first == all.end() ? nullptr : first->get();
}

void add_once(const std::string& name, std::vector<std::string>& names) {
  if (!contains(names, name)) names.push_back(name);
}

// The terms that the simulation has, and the effects that were searched for.
void list_terms(const Relation& relation, Verdict& verdict) {
  for (const auto& term : relation.base().terms) add_once(term.settings.name, verdict.assumed);
  for (const auto& candidate : relation.candidates(relation.base()))
    add_once(candidate.name, verdict.searched);
}

// Moves the causes of an investigation to the front.
void put_first(const Investigation& shown, std::vector<Cause>& causes) {
  const auto& rounds = shown.selection.rounds;
  std::stable_partition(causes.begin(), causes.end(), [&](const Cause& cause) {
    return std::any_of(rounds.begin(), rounds.end(), [&](const SelectionRound& round) {
      return round.chosen.candidate.name == cause.name &&
             round.chosen.candidate.channel == cause.channel;
    });
  });
}

// The relation that is shown comes last, since what there is once is its own. Its evidence and its
// forms come first.
void report_all(const Investigations& all, const Investigation& shown, Verdict& verdict) {
  add_evidence(shown, verdict);
  add_descriptions(shown, verdict);
  // The first form of an unknown residual is taken for the best of it.
  const bool has_no_form = shown.is_unknown() && verdict.descriptions.empty();
  for (const auto& found : all) {
    if (found.get() == &shown || (!found->is_named() && !found->is_unknown())) continue;
    add_evidence(*found, verdict);
    if (!has_no_form) add_descriptions(*found, verdict);
    report(*found, verdict);
  }
  report(shown, verdict);
}

// Missing takes precedence over unknown, unknown over none; a relation further up the chain is
// reported first.
void conclude(const Investigations& all, const Case& c, Verdict& verdict) {
  const Investigation* explained = first_where(all, is_explained);
  const Investigation* unknown =
      first_where(all, [](const Investigation& found) { return found.is_unknown(); });
  const Investigation* shown = explained != nullptr ? explained
                               : unknown != nullptr ? unknown
                                                    : all.back().get();
  report_all(all, *shown, verdict);
  verdict.where = where_of(*shown, c.map);
  if (shown->is_named()) verdict.where.part = shown->selection.rounds[0].chosen.candidate.part;
  put_first(*shown, verdict.causes);
  for (const auto& found : all) {
    if (is_composition(c.model.kind)) verdict.fragment += fragment_of(*found);
    list_terms(*found->relation, verdict);
    if (found->is_unknown()) verdict.unexplained.push_back(output_of(*found));
  }
  verdict.outcome = explained != nullptr ? Outcome::Missing
                    : unknown != nullptr ? Outcome::Unknown
                                         : Outcome::None;
  verdict.has_remainder =
      verdict.outcome == Outcome::Missing && (unknown != nullptr || shown->has_remainder());
}

// The cause of a verdict that a selection round names; null if it names none.
Cause* cause_of(const SelectionRound& round, Verdict& verdict) {
  for (auto& cause : verdict.causes)
    if (cause.name == round.chosen.candidate.name &&
        cause.channel == round.chosen.candidate.channel)
      return &cause;
  return nullptr;
}

// Adds the proposed test, and what separates each cause from its alternatives.
void propose(const NextTest& next, Verdict& verdict) {
  verdict.next_test = next.text;
  verdict.next_motion = next.motion;
  for (const auto& one : next.separating)
    if (Cause* cause = cause_of(*one.round, verdict)) {
      cause->alternatives[one.tied].test = one.text;
      cause->alternatives[one.tied].sigma = one.sigma;
    }
  for (const auto* round : next.inseparable)
    if (const Cause* cause = cause_of(*round, verdict))
      verdict.limits.push_back(fmt::format(
          "No known test within {} times the recorded amplitude, rate and acceleration "
          "separates {} from its alternatives{}.",
          kReach, cause->name,
          cause->alternatives.size() > kMostRivals
              ? fmt::format("; {} of {} were examined", kMostRivals, cause->alternatives.size())
              : ""));
}

// Examines the relations of a case. What the accelerometer's shows corrects the case for the
// others.
Investigations investigations_of(Case& c, const SensorNoise& noise, const DiagnosisOptions& options,
                                 Progress& progress) {
  Investigations all;
  for (const RelationOf relation_of : relations_of_kind(c.model.kind)) {
    auto relation = relation_of(c, options.without);
    if (!relation) continue;
    check_outputs(*relation, moving_records(c));
    all.push_back(investigate(std::move(relation), c.records, noise, options.seed, progress));
    if (relation_of == accelerometer_relation)
      correct_accelerometers(all.back()->selection.named, c);
  }
  if (all.empty()) throw_without_relation(c);
  return all;
}

// Coarse quantisation is the verdict where nothing else is named.
void name_lattices(const std::vector<Lattice>& lattices, Verdict& verdict) {
  add_lattices(lattices, verdict);
  const auto is_rule = [](const Cause& cause) { return cause.is_rule; };
  const auto first_rule =
      std::stable_partition(verdict.causes.begin(), verdict.causes.end(), std::not_fn(is_rule));
  const auto named = static_cast<std::size_t>(first_rule - verdict.causes.begin());
  if (verdict.outcome != Outcome::None && named != lattices_named(lattices)) return;
  verdict.has_remainder = verdict.has_remainder || verdict.outcome == Outcome::Unknown;
  verdict.outcome = Outcome::Missing;
  verdict.where.part = Part::Sensor;
  verdict.where.channel = family_of(lattices[0].role);
}

}  // namespace

Verdict diagnose(const Case& given, const DiagnosisOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  Case c = given;
  check_case(c, options.without);
  std::vector<const Record*> noisy;
  for (const auto& record : c.records) noisy.push_back(&record);
  auto lattices = coarse_lattices(moving_records(c));
  const SensorNoise noise{noisy, c.noise, rounding_of(lattices)};
  std::erase_if(lattices, [&](const Lattice& lattice) {
    return has_rounding(c, lattice.role) ||
           is_barred(options.without, quantisation_of(lattice), "quantisation");
  });
  Verdict verdict;
  verdict.case_name = c.name;
  Progress progress{options.progress};
  const Investigations all = investigations_of(c, noise, options, progress);
  progress.enter("");
  progress.begin_stage("place, intervals");
  conclude(all, c, verdict);
  progress.begin_stage("next test");
  propose(next_test(all, c.model.kind == "bearing", verdict.outcome == Outcome::Unknown), verdict);
  if (!lattices.empty()) name_lattices(lattices, verdict);
  if (!verdict.causes.empty())
    verdict.improved = improved_case(given, improved_model(c, all, lattices));
  double confidence = 1;
  for (const auto& cause : verdict.causes) confidence = std::min(confidence, cause.confidence);
  verdict.confidence = confidence;
  add_limits(c, noise, all, verdict);
  verdict.sentence = sentence_of(verdict);
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return verdict;
}

}  // namespace rths::diagnosis
