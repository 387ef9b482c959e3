// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <rths/core/axis.hpp>
#include <rths/sim/composition.hpp>
#include <rths/verdict/diagnose.hpp>
#include <string>
#include <vector>

#include <algorithm>
#include <chrono>
#include <functional>
#include <iterator>
#include <set>

#include <fmt/format.h>

#include <rths/cases/bounded.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment_design/proposal.hpp>
#include <rths/identification/constants.hpp>
#include <rths/identification/lattice.hpp>
#include <rths/identification/relation_findings.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/models/barred.hpp>
#include <rths/models/relations.hpp>
#include <rths/sim/term.hpp>

#include "check_records.hpp"
#include "confidence.hpp"
#include "deviations.hpp"
#include "improved.hpp"
#include "limits.hpp"
#include "relations_of_case.hpp"
#include "report.hpp"
#include "where.hpp"

namespace rths::diagnosis {
namespace {

using PerAxis = std::array<double, sim::kHorizontalAxes>;

// The channels of one record that the correction of accelerometers uses, by axis; null: none.
struct AccelerometerChannels {
  std::array<Channel*, sim::kHorizontalAxes> acceleration{};
  std::array<const Channel*, sim::kHorizontalAxes> displacement{};

  explicit AccelerometerChannels(Record& record) {
    for (auto& channel : record.channels)
      for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
        const char* name = name_of(kHorizontal[axis]);
        if (channel.role == fmt::format("acceleration.{}", name)) acceleration[axis] = &channel;
        if (channel.role == fmt::format("displacement.{}", name)) displacement[axis] = &channel;
      }
  }
  [[nodiscard]] std::vector<PerAxis> measured(std::size_t samples) const {
    std::vector<PerAxis> values(samples);
    for (std::size_t k = 0; k < samples; ++k)
      for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
        values[k][axis] = acceleration[axis] != nullptr ? acceleration[axis]->values[k] : 0;
    return values;
  }
  void set(const std::vector<PerAxis>& corrected) const {
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
      if (acceleration[axis] != nullptr)
        for (std::size_t k = 0; k < corrected.size(); ++k)
          acceleration[axis]->values[k] = corrected[k][axis];
  }
};

// Parameters of a composition of a hypothesis' terms at its values.
std::vector<double> parameters_at(const Hypothesis& hypothesis,
                                  const sim::Composition& composition) {
  std::vector<double> parameters(composition.parameters().begin(), composition.parameters().end());
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const std::string& name = hypothesis.free[i].name;
    const auto dot = name.rfind('.');
    const std::string prefix = name.substr(0, dot);
    for (const auto& term : composition.terms())
      if (term.name == prefix || term.name.starts_with(prefix + "."))
        parameters[composition.parameter_index(term.name, name.substr(dot + 1))] =
            hypothesis.values[static_cast<Index>(i)];
  }
  return parameters;
}

// One iteration of a = T⁻¹(y): adds the difference between y and T(a) to a.
void improve(std::vector<PerAxis>& a, const std::vector<PerAxis>& y, const Record& record,
             const AccelerometerChannels& channels, const sim::Composition& composition,
             const std::vector<double>& parameters) {
  std::vector<double> state(composition.states());
  for (std::size_t k = 0; k < a.size(); ++k) {
    sim::Quantities<double> q;
    q.time = record.start + static_cast<double>(k) * record.time_step;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      q.acceleration[axis] = a[k][axis];
      if (channels.displacement[axis] != nullptr)
        q.displacement[axis] = channels.displacement[axis]->values[k];
    }
    composition.advance(parameters, state, q);
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis)
      a[k][axis] += y[k][axis] - q.acceleration[axis];
  }
}

// Removes the faults T of an accelerometer from its channels y, so that later relations see
// corrected accelerations: a = T⁻¹(y) by iteration, since the faults are small. Changes nothing if
// no fault is named.
// @param named  model of the accelerometer
void correct_accelerometers(const Hypothesis& named, Case& c) {
  constexpr int kRounds = 3;
  if (named.terms.empty()) return;
  std::vector<sim::TermSettings> terms;
  for (const auto& term : named.terms) terms.push_back(term.settings);
  for (auto& record : c.records) {
    const AccelerometerChannels channels{record};
    const sim::Composition composition{terms, record.time_step};
    const auto parameters = parameters_at(named, composition);
    const auto measured = channels.measured(record.samples());
    auto corrected = measured;
    for (int round = 0; round < kRounds; ++round)
      improve(corrected, measured, record, channels, composition, parameters);
    channels.set(corrected);
  }
}

std::string quantisation_of(const Lattice& lattice) {
  return family_of(lattice.role) + "_quantisation";
}

void add_lattices(const std::vector<Lattice>& lattices, std::vector<Cause>& causes) {
  for (const auto& lattice : lattices) {
    const std::string family = family_of(lattice.role);
    const std::string name = quantisation_of(lattice);
    const auto known = std::find_if(causes.begin(), causes.end(),
                                    [&](const Cause& cause) { return cause.name == name; });
    const double half = maths::kNormal95 * lattice.deviation;
    const Estimate step{lattice.role + ".step", lattice.unit, lattice.step, lattice.step - half,
                        lattice.step + half};
    if (known != causes.end()) {
      known->parameters.push_back(step);
      continue;
    }
    Cause cause;
    cause.name = name;
    cause.title = "coarse steps of the " + family + " sensor";
    cause.equation = sim::term_kind("quantisation").equation;
    cause.part = Part::Sensor;
    cause.channel = family;
    cause.confidence = std::min(lattice.on_steps, kMostSure);
    cause.explained = std::nan("");
    cause.parameters = {step};
    causes.push_back(std::move(cause));
  }
}

// Number of causes: one for each family of channels.
std::size_t lattices_named(const std::vector<Lattice>& lattices) {
  std::set<std::string> families;
  for (const auto& lattice : lattices) families.insert(family_of(lattice.role));
  return families.size();
}

// Findings with a cause and nothing unknown.
bool is_explained(const RelationFindings& found) { return found.is_named() && !found.is_unknown(); }

template <class Condition>
const RelationFindings* first_where(const AllFindings& all, const Condition& holds) {
  const auto first =
      std::find_if(all.begin(), all.end(), [&](const auto& found) { return holds(*found); });
  return first == all.end() ? nullptr : first->get();
}

template <class Value>
void append(std::vector<Value> more, std::vector<Value>& all) {
  std::move(more.begin(), more.end(), std::back_inserter(all));
}

void add_once(const std::string& name, std::vector<std::string>& names) {
  if (!contains(names, name)) names.push_back(name);
}

// The terms that the simulation has, and the effects that were searched for.
ConsideredTerms terms_of(const AllFindings& all) {
  ConsideredTerms terms;
  for (const auto& found : all) {
    const Relation& relation = *found->relation;
    for (const auto& term : relation.base().terms) add_once(term.settings.name, terms.assumed);
    for (const auto& candidate : relation.candidates(relation.base()))
      add_once(candidate.name, terms.searched);
  }
  return terms;
}

bool names(const SelectionRound& round, const Cause& cause) {
  const Candidate& candidate = round.chosen.candidate;
  return candidate.name == cause.name && candidate.channel == cause.channel;
}

/// Findings by what they show. Missing takes precedence over unknown, unknown over none; a
/// relation further up the chain is reported first.
struct Ranking {
  explicit Ranking(const AllFindings& all)
      : explained{first_where(all, is_explained)},
        unknown{first_where(all, [](const RelationFindings& one) { return one.is_unknown(); })},
        shown{explained != nullptr ? explained
              : unknown != nullptr ? unknown
                                   : all.back().get()} {}

  const RelationFindings *explained, *unknown;  ///< the first ones; null if there is none
  const RelationFindings* shown;

  [[nodiscard]] Outcome outcome() const {
    return explained != nullptr ? Outcome::Missing
           : unknown != nullptr ? Outcome::Unknown
                                : Outcome::None;
  }
};

// Findings in the order in which a verdict reports them, the shown one last.
std::vector<const RelationFindings*> in_order(const AllFindings& all,
                                              const RelationFindings& shown) {
  std::vector<const RelationFindings*> order;
  for (const auto& found : all)
    if (found.get() != &shown && (found->is_named() || found->is_unknown()))
      order.push_back(found.get());
  order.push_back(&shown);
  return order;
}

// The cause that a selection round names; null if none does.
Cause* cause_of(const SelectionRound& round, std::vector<Cause>& causes) {
  const auto named = std::find_if(causes.begin(), causes.end(),
                                  [&](const Cause& cause) { return names(round, cause); });
  return named == causes.end() ? nullptr : &*named;
}

// Causes of all relations, those of the shown one first, with what separates each from its
// alternatives.
std::vector<Cause> causes_of(const AllFindings& all, const Covariances& covariances,
                             const RelationFindings& shown, const TestProposal& next) {
  std::vector<Cause> causes;
  for (const RelationFindings* found : in_order(all, shown))
    if (found->is_named()) append(causes_of(*found, covariances.at(found)), causes);
  const auto& rounds = shown.selection.rounds;
  std::stable_partition(causes.begin(), causes.end(), [&](const Cause& cause) {
    return std::any_of(rounds.begin(), rounds.end(),
                       [&](const SelectionRound& round) { return names(round, cause); });
  });
  for (const auto& one : next.separating)
    if (Cause* cause = cause_of(*one.round, causes)) {
      cause->alternatives[one.tied].test = one.text;
      cause->alternatives[one.tied].sigma = one.sigma;
    }
  return causes;
}

// Causes that no known test separates from their alternatives.
std::vector<std::string> inseparable_of(const TestProposal& next, std::vector<Cause> causes) {
  std::vector<std::string> limits;
  for (const auto* round : next.inseparable)
    if (const Cause* cause = cause_of(*round, causes))
      limits.push_back(fmt::format(
          "No known test within {} times the recorded amplitude, rate and acceleration "
          "separates {} from its alternatives{}.",
          kReach, cause->name,
          cause->alternatives.size() > kMostRivals
              ? fmt::format("; {} of {} were examined", kMostRivals, cause->alternatives.size())
              : ""));
  return limits;
}

// Examines the relations of a case. What the accelerometer's shows corrects the case for the
// others.
AllFindings findings_of(Case& c, const SensorNoise& noise, const DiagnosisOptions& options,
                        DiagnosisProgress& progress) {
  AllFindings all;
  for (const RelationOf relation_of : relations_of_kind(c.model.kind)) {
    auto relation = relation_of(c, options.without);
    if (!relation) continue;
    check_outputs(*relation, moving_records(c));
    all.push_back(examine(std::move(relation), c.records, noise, options.seed, progress));
    if (relation_of == accelerometer_relation)
      correct_accelerometers(all.back()->selection.named, c);
  }
  if (all.empty()) throw_without_relation(c);
  return all;
}

// Coarse quantisation is the verdict where nothing else is named.
void name_lattices(const std::vector<Lattice>& lattices, Conclusion& conclusion) {
  auto& causes = conclusion.causes;
  add_lattices(lattices, causes);
  const auto is_rule = [](const Cause& cause) { return cause.is_rule; };
  const auto first_rule = std::stable_partition(causes.begin(), causes.end(), std::not_fn(is_rule));
  const auto named = static_cast<std::size_t>(first_rule - causes.begin());
  if (conclusion.outcome != Outcome::None && named != lattices_named(lattices)) return;
  conclusion.has_remainder = conclusion.has_remainder || conclusion.outcome == Outcome::Unknown;
  conclusion.outcome = Outcome::Missing;
  conclusion.where.part = Part::Sensor;
  conclusion.where.channel = family_of(lattices[0].role);
}

// The law of which all guesses are parts is what is known of the form.
void describe_guesses(const RelationFindings& shown, Verdict& verdict) {
  if (!shown.common_law || verdict.conclusion.outcome != Outcome::Unknown ||
      verdict.conclusion.causes.empty())
    return;
  Description law = *shown.common_law;
  law.share = shown.proof.explained();
  law.channel = output_of(shown);
  verdict.descriptions.insert(verdict.descriptions.begin(), std::move(law));
}

Conclusion conclude(const AllFindings& all, const Ranking& ranking, std::vector<Cause> causes,
                    Where where, const std::vector<Lattice>& lattices) {
  const RelationFindings& shown = *ranking.shown;
  Conclusion conclusion;
  conclusion.outcome = ranking.outcome();
  conclusion.causes = std::move(causes);
  conclusion.has_remainder = conclusion.outcome == Outcome::Missing &&
                             (ranking.unknown != nullptr || shown.has_remainder());
  for (const auto& found : all) {
    if (found->is_unknown()) conclusion.unexplained.push_back(output_of(*found));
    for (const auto& [candidate, reason] : found->withdrawn)
      conclusion.withdrawn.push_back(candidate.title);
  }
  conclusion.where = std::move(where);
  if (!conclusion.causes.empty()) conclusion.where.part = conclusion.causes[0].part;
  if (!lattices.empty()) name_lattices(lattices, conclusion);
  doubt_guesses(conclusion);
  conclusion.confidence = confidence_in_outcome(
      conclusion, std::all_of(all.begin(), all.end(),
                              [](const auto& found) { return found->problem->is_noise_known(); }));
  return conclusion;
}

ImprovedModel improvement_of(const Case& given, const Case& c, const AllFindings& all,
                             const std::vector<Lattice>& lattices, bool has_causes) {
  ImprovedModel improvement;
  if (is_composition(c.model.kind))
    for (const auto& found : all) improvement.fragment += fragment_of(*found);
  if (has_causes) improvement.source = improved_case(given, improved_model(c, all, lattices));
  return improvement;
}

// A path with too few rows to guess its noise has no velocity either: its rows are steps of a
// quasi-static test, whatever their rate is said to be. @returns whether the case lost its times
bool forget_times(const SensorNoise& noise, Case& c) {
  const auto& unknown = noise.unknown();
  const bool is_coarse = std::any_of(unknown.begin(), unknown.end(), [](const std::string& role) {
    return role.starts_with("displacement.");
  });
  const bool is_static = c.model.kind == ModelKind::Bearing || c.model.kind == ModelKind::Platen;
  if (!is_coarse || !is_static || has_terms_of_time(c)) return false;
  for (const auto& record : c.records)
    for (const auto& channel : record.channels)
      if (const std::string family = family_of(channel.role);
          !record.has_time || family == "acceleration" || family == "velocity" ||
          family == "command")
        return false;
  for (auto& record : c.records) {
    record.settle /= record.time_step;
    record.start = record.time_step = 1;
    record.has_time = false;
  }
  return true;
}

SensorNoise noise_of(const Case& c, const std::vector<Lattice>& lattices) {
  std::vector<const Record*> records;
  for (const auto& record : c.records) records.push_back(&record);
  return {records, c.noise, rounding_of(lattices)};
}

// Everything that a case shows, but its name and the time taken.
Verdict verdict_on(const Case& given, const DiagnosisOptions& options,
                   DiagnosisProgress& progress) {
  Case c = given;
  check_case(c, options.without);
  std::vector<std::string> lost = bound_records(c);
  auto lattices = coarse_lattices(moving_records(c));
  SensorNoise noise = noise_of(c, lattices);
  if (forget_times(noise, c)) {
    noise = noise_of(c, lattices);
    lost.emplace_back(
        "The displacement has too few rows in a cycle for a velocity, so that times are not used: "
        "laws of a rate were not searched for.");
  }
  std::erase_if(lattices, [&](const Lattice& lattice) {
    return has_rounding(c, lattice.role) ||
           is_barred(options.without, quantisation_of(lattice), "quantisation");
  });
  const AllFindings all = findings_of(c, noise, options, progress);
  const Ranking ranking{all};
  const RelationFindings& shown = *ranking.shown;
  progress.enter("");
  progress.begin_stage("place, intervals");
  Verdict verdict;
  for (const RelationFindings* found : in_order(all, shown)) {
    append(withdrawn_of(*found), verdict.limits);
    const ReducedModels reduced = reduced_models(*found);
    append(ablation_of(*found, reduced), verdict.ablation);
    if (found == &shown) verdict.evaluation = evaluation_of(shown, reduced);
  }
  verdict.relations = {verdict_of(shown)};
  for (const auto& found : all)
    if (found.get() != &shown) verdict.relations.push_back(verdict_of(*found));
  Where where = where_of(shown, c.map);
  verdict.evidence = evidence_of(all, shown);
  verdict.descriptions = descriptions_of(all, shown);
  verdict.terms = terms_of(all);
  progress.begin_stage("next test");
  TestProposal next =
      propose_test(all, c.model.kind == ModelKind::Bearing, ranking.outcome() == Outcome::Unknown);
  const Covariances covariances = covariances_of(all);
  auto causes = causes_of(all, covariances, shown, next);
  append(inseparable_of(next, causes), verdict.limits);
  verdict.next = {std::move(next.text), std::move(next.motion)};
  verdict.conclusion = conclude(all, ranking, std::move(causes), std::move(where), lattices);
  describe_guesses(shown, verdict);
  verdict.improvement = improvement_of(given, c, all, lattices, !verdict.conclusion.causes.empty());
  if (is_composition(c.model.kind)) {
    verdict.improvement.deviations = deviations_of(all, covariances);
    verdict.improvement.remainder = remainder_of(verdict.evaluation);
  }
  verdict.noise = noise_basis(c, noise);
  append(limits_of(c, noise, all), verdict.limits);
  append(lost, verdict.limits);
  return verdict;
}

}  // namespace

Verdict diagnose(const Case& given, const DiagnosisOptions& options) {
  const auto begin = std::chrono::steady_clock::now();
  DiagnosisProgress progress{options.progress};
  Verdict verdict = verdict_on(given, options, progress);
  verdict.case_name = given.name;
  verdict.specimen = specimen_of(given);
  verdict.sentence = sentence_of(verdict);
  verdict.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return verdict;
}

}  // namespace rths::diagnosis
