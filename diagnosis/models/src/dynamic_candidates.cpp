// SPDX-License-Identifier: Apache-2.0
#include "dynamic_candidates.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "dynamic_kinds.hpp"
#include "library.hpp"

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::VectorXd;

struct TermSite {
  std::string name, title, channel;
  Part part;
  UnitScales scales;
  Natural natural;
  bool is_only_one;  // of its type: its terms are named without the component
};

// All combinations of the choices' starts.
std::vector<VectorXd> start_grid(const std::vector<const ParameterChoice*>& free,
                                 const std::vector<FreeParameter>& parameters,
                                 const Natural& natural) {
  std::vector<VectorXd> starts{VectorXd(static_cast<Index>(free.size()))};
  for (std::size_t i = 0; i < free.size(); ++i) {
    std::vector<VectorXd> more;
    for (const VectorXd& start : starts)
      for (const double start_size : free[i]->starts) {
        more.push_back(start);
        more.back()[static_cast<Index>(i)] = std::clamp(
            start_size * size_of(free[i]->unit, natural), parameters[i].low, parameters[i].high);
      }
    starts = std::move(more);
  }
  return starts;
}

// Limits a shape to the range in which it has an effect; a wider search only takes time.
void confine(const ParameterChoice& choice, double size, FreeParameter& parameter) {
  constexpr double kWithin = 10;
  const auto [least, most] = std::minmax_element(choice.starts.begin(), choice.starts.end());
  parameter.low = std::max(parameter.low, *least * size / kWithin);
  parameter.high = std::min(parameter.high, *most * size * kWithin);
}

Candidate candidate_of(const KindChoice& kind, const TermSite& site) {
  const sim::TermKind& term = sim::term_kind(kind.kind);
  Candidate candidate;
  candidate.name = candidate.kind = kind.kind;
  candidate.title = fmt::format("{} {}", term.title, site.title);
  candidate.equation = term.equation;
  candidate.part = site.part;
  candidate.channel = site.channel;
  ModelTerm added{{kind.kind, "", {}}, site.name};
  added.settings.name = site.is_only_one ? kind.kind : site.name + "." + kind.kind;
  std::vector<const ParameterChoice*> free;
  for (const auto& choice : kind.choices) {
    const sim::Parameter& parameter = parameter_of(term, choice.name);
    const double size = size_of(choice.unit, site.natural);
    const double unit = site.scales.of(parameter.unit);
    added.settings.parameters.emplace_back(
        choice.name,
        std::clamp(choice.starts[0] * size, parameter.low * unit, parameter.high * unit));
    if (choice.role == ParameterChoice::Stated) continue;
    candidate.frees.push_back(free_parameter(added.settings.name + "." + choice.name, parameter,
                                             site.scales, 0.1 * std::abs(choice.starts[0]) * size));
    if (choice.role == ParameterChoice::Shape)
      confine(choice, size, candidate.frees.back());
    else
      candidate.frees.back().absent = parameter.absent * unit;
    free.push_back(&choice);
  }
  candidate.starts = start_grid(free, candidate.frees, site.natural);
  candidate.price = static_cast<int>(free.size());
  candidate.after = candidate.contains = kind.after;
  candidate.adds.push_back(std::move(added));
  return candidate;
}

bool is_in_model(const Hypothesis& base, const std::string& kind, const std::string& component) {
  return std::any_of(base.terms.begin(), base.terms.end(), [&](const ModelTerm& term) {
    return term.settings.kind == kind && term.component == component;
  });
}

bool is_free(const Hypothesis& base, const std::string& name) {
  return std::any_of(base.free.begin(), base.free.end(),
                     [&](const FreeParameter& free) { return free.name == name; });
}

// Whether the connection has the mass or spring that the term needs.
bool is_possible(const std::string& kind, const ConnectionSize& size) {
  if (kind == "platen_inertia") return size.acceleration > 0;
  return size.has_spring || sim::term_kind(kind).stage != sim::Stage::Motion;
}

std::vector<KindChoice> possible_kinds(const ConnectionSize& size) {
  std::vector<KindChoice> kinds = connection_kinds();
  std::erase_if(kinds, [&](const KindChoice& kind) { return !is_possible(kind.kind, size); });
  return kinds;
}

// A modifier needs a term that it weakens.
bool has_what_it_changes(const std::string& kind, const Hypothesis& base,
                         const std::string& component) {
  if (sim::term_kind(kind).stage != sim::Stage::Modifier) return true;
  return std::any_of(base.terms.begin(), base.terms.end(), [&](const ModelTerm& term) {
    return term.component == component && is_hysteretic(term.settings.kind);
  });
}

void add_candidates(const std::vector<KindChoice>& kinds, const TermSite& site,
                    const Hypothesis& base, std::vector<Candidate>& candidates) {
  for (const auto& kind : kinds) {
    if (is_in_model(base, kind.kind, site.name)) continue;
    if (!has_what_it_changes(kind.kind, base, site.name)) continue;
    // A fitted linear damper makes a second one redundant.
    if (std::string_view{kind.kind} == "viscous_friction" && is_free(base, site.name + ".damping"))
      continue;
    candidates.push_back(candidate_of(kind, site));
  }
}

Natural natural_of_signal(const SignalSize& size, double time_step) {
  return {size.peak, size.rate, 0, size.peak, size.peak, size.rms, time_step, 0};
}

Natural natural_of_connection(const ConnectionSize& size, double time_step) {
  const double period = 2 * 3.141592653589793 * size.displacement / size.velocity;
  return {size.displacement, size.velocity, size.acceleration, size.force, 0, 0, time_step, period};
}

// A parameter of the linear system with a wrong value.
Candidate wrong_parameter(const ModelParameter& parameter, const DynamicSizes& sizes) {
  Candidate candidate;
  candidate.name = parameter.error;
  candidate.title = fmt::format("{} is wrong", parameter.name);
  candidate.equation =
      fmt::format("{} is not {} {}", parameter.name, parameter.value, parameter.unit);
  candidate.part = Part::Structure;
  candidate.channel = parameter.name;
  double size = std::abs(parameter.value);
  if (parameter.joins) {
    const auto& [input, output] = *parameter.joins;
    size = sizes.outputs[output].peak / sizes.inputs[input].peak;
    candidate.title = "direct feed-through";
    candidate.equation = "y = C x + d u";
    candidate.frees.push_back({parameter.name, parameter.unit, -10 * size, 10 * size, 0.02 * size});
    candidate.starts.push_back(VectorXd::Constant(1, 0.02 * size));
  } else {
    candidate.frees.push_back({parameter.name, parameter.unit, 0.1 * size, 10 * size, 0.02 * size});
    if (parameter.value < 0) std::swap(candidate.frees[0].low *= -1, candidate.frees[0].high *= -1);
    candidate.starts.push_back(VectorXd::Constant(1, parameter.value * 1.02));
  }
  candidate.frees[0].absent = parameter.joins ? 0 : parameter.value;
  candidate.price = 1;
  return candidate;
}

}  // namespace

FreeParameter free_parameter(const std::string& name, const sim::Parameter& parameter,
                             const UnitScales& scales, double size) {
  const double unit = scales.of(parameter.unit);
  return {name, std::string{parameter.unit}, parameter.low * unit, parameter.high * unit,
          size > 0 ? size : 0.1 * std::abs(parameter.typical) * unit};
}

std::vector<Candidate> dynamic_candidates(const DynamicModel& model, const DynamicSizes& sizes,
                                          const Hypothesis& base) {
  std::vector<Candidate> candidates;
  for (std::size_t i = 0; i < model.connections.size(); ++i) {
    const ConnectionSize& size = sizes.connections[i];
    if (!(size.displacement > 0 && size.velocity > 0 && size.force > 0)) continue;
    add_candidates(possible_kinds(size),
                   {model.connections[i].component, model.connections[i].title,
                    model.connections[i].seen, Part::Structure, sizes.of_connection(size),
                    natural_of_connection(size, sizes.time_step), model.connections.size() == 1},
                   base, candidates);
  }
  const auto add_signals = [&](const std::vector<std::string>& roles,
                               const std::vector<SignalSize>& signal_sizes,
                               const std::vector<KindChoice>& kinds, Part part) {
    for (std::size_t i = 0; i < roles.size(); ++i)
      if (signal_sizes[i].peak > 0)
        add_candidates(
            kinds,
            {roles[i], "at " + roles[i], roles[i], part, sizes.of_signal(signal_sizes[i]),
             natural_of_signal(signal_sizes[i], sizes.time_step), false},
            base, candidates);
  };
  if (model.has_terms_on_inputs)
    add_signals(model.inputs, sizes.inputs, input_kinds(), Part::Actuator);
  add_signals(model.outputs, sizes.outputs, output_kinds(), Part::Sensor);
  for (const auto& parameter : model.parameters)
    if (!parameter.error.empty() && (parameter.value != 0 || parameter.joins) &&
        !is_free(base, parameter.name))
      candidates.push_back(wrong_parameter(parameter, sizes));
  return candidates;
}

}  // namespace rths::diagnosis
