// SPDX-License-Identifier: Apache-2.0
#include "dynamic_candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/text.hpp>
#include <rths/sim/tables.hpp>

#include "library.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kReach = 1.2;     // of the largest motion in the simulation as stated
constexpr double kMostForce = 10;  // of the connection's force
constexpr double kScale = 0.05;    // of the connection's force
constexpr double kCreep = 0.01;    // of the largest velocity
// In the travel from end to end: fewer periods may be any curve.
constexpr double kLeastPeriods = 3, kMostPeriods = 24, kPeriodStep = 0.5;

struct FormKind {
  const char* kind;
  const char* name;  // of the form
  bool over_velocity, is_viscosity;
};
constexpr FormKind kKinds[] = {{"tabulated_stiffness", "f(u)", false, false},
                               {"tabulated_damping", "f(v)", true, false},
                               {"tabulated_friction", "sgn(v) g(u)", false, false},
                               {"tabulated_viscosity", "v g(u)", false, true}};

FreeForm form_of(const FormKind& form, const Connection& connection, const ConnectionSize& size) {
  const sim::TermKind& kind = sim::term_kind(form.kind);
  Candidate candidate;
  candidate.name = fmt::format("{} {}", form.name, connection.title);
  candidate.kind = form.kind;
  candidate.channel = connection.seen;
  ModelTerm term{{form.kind, connection.component + "." + form.kind, {}}, connection.component};
  auto& stated = term.settings.parameters;
  const double range = kReach * (form.over_velocity ? size.velocity : size.displacement);
  stated.emplace_back("range", range);
  const double natural = form.is_viscosity ? size.force / size.velocity : size.force;
  for (const auto& parameter : kind.parameters) {
    if (parameter.name == "creep_velocity")
      stated.emplace_back("creep_velocity", kCreep * size.velocity);
    if (!parameter.name.starts_with("value_")) continue;
    candidate.frees.push_back({fmt::format("{}.{}", term.settings.name, parameter.name),
                               std::string{parameter.unit}, -kMostForce * natural,
                               kMostForce * natural, kScale * natural, false, 0.0});
  }
  candidate.starts = {VectorXd::Zero(static_cast<Index>(candidate.frees.size()))};
  candidate.price = static_cast<int>(candidate.frees.size());
  candidate.adds.push_back(std::move(term));
  FreeForm result{
      std::move(candidate), form.over_velocity ? "velocity [m/s]" : "displacement [m]", {}};
  for (const double knot : form.over_velocity ? sim::kDenseKnots : sim::kEvenKnots)
    result.knots.push_back(knot * range);
  return result;
}

// A force periodic in displacement. The sign of the force and two phases make all phases near.
FreeForm periodic_form(const Connection& connection, const ConnectionSize& size) {
  Candidate candidate;
  candidate.name = fmt::format("periodic in displacement {}", connection.title);
  candidate.kind = "cogging";
  candidate.channel = connection.seen;
  const std::string name = connection.component + ".cogging";
  candidate.adds.push_back({{candidate.kind, name, {}}, connection.component});
  const double travel = 2 * size.displacement;
  constexpr double kPi = std::numbers::pi;
  candidate.frees = {{name + ".force", "N", -kMostForce * size.force, kMostForce * size.force,
                      kScale * size.force, false, 0.0},
                     {name + ".pitch", "m", travel / kMostPeriods, travel / kLeastPeriods,
                      travel / (4 * kMostPeriods)},
                     {name + ".phase", "rad", -kPi, kPi, 0.5}};
  for (double periods = kLeastPeriods; periods <= kMostPeriods; periods += kPeriodStep)
    for (const double phase : {0.0, kPi / 2})
      candidate.starts.push_back(Eigen::Vector3d{kScale * size.force, travel / periods, phase});
  candidate.price = static_cast<int>(candidate.frees.size());
  return {std::move(candidate), "", {}};
}

struct TermSite {
  std::string name, title, channel;
  Part part;
  UnitScales scales;
  NaturalScale natural;
  bool is_only_one;  // of its type
  bool has_time;
  UnitSymbols symbols;
};

bool is_fitted(const CandidateParameter& choice) {
  return choice.role == CandidateParameter::Role::Size ||
         choice.role == CandidateParameter::Role::Shape;
}

// All combinations of the parameters' starts.
std::vector<VectorXd> start_grid(const std::vector<const CandidateParameter*>& free,
                                 const std::vector<double>& sizes,
                                 const std::vector<FreeParameter>& parameters) {
  std::vector<VectorXd> starts{VectorXd(static_cast<Index>(free.size()))};
  for (std::size_t i = 0; i < free.size(); ++i) {
    std::vector<VectorXd> more;
    for (const VectorXd& start : starts)
      for (const double start_size : free[i]->starts) {
        more.push_back(start);
        more.back()[static_cast<Index>(i)] =
            std::clamp(start_size * sizes[i], parameters[i].low, parameters[i].high);
      }
    starts = std::move(more);
  }
  return starts;
}

// @param is_only_one  its terms are named without the component
Candidate candidate_of(const CandidateTerm& entry, const TermSite& site, bool is_only_one) {
  const sim::TermKind& term = sim::term_kind(entry.kind);
  Candidate candidate;
  candidate.name = candidate.kind = entry.kind;
  candidate.title = fmt::format("{} {}", term.title, site.title);
  candidate.equation = term.equation;
  candidate.part = site.part;
  candidate.channel = site.channel;
  ModelTerm added{{candidate.kind, "", {}}, site.name};
  added.settings.name = is_only_one ? candidate.kind : site.name + "." + candidate.kind;
  std::vector<const CandidateParameter*> free;
  std::vector<double> sizes;
  for (const auto& choice : entry.parameters) {
    const sim::Parameter& parameter = parameter_of(term, choice.name);
    const double size = natural_unit(parameter.unit, site.natural);
    const double unit = site.scales.of(parameter.unit);
    added.settings.parameters.emplace_back(
        choice.name,
        std::clamp(choice.starts[0] * size, parameter.low * unit, parameter.high * unit));
    if (!is_fitted(choice)) continue;
    candidate.frees.push_back(free_parameter(fmt::format("{}.{}", added.settings.name, choice.name),
                                             parameter, site.scales,
                                             0.1 * std::abs(choice.starts[0]) * size));
    FreeParameter& freed = candidate.frees.back();
    freed.unit = site.symbols.of(parameter.unit);
    if (freed.unit.starts_with(sim::kChannelUnit))
      freed.unit.replace(0, sim::kChannelUnit.size(), site.symbols.force);
    if (choice.low < choice.high) {
      freed.low = std::max(freed.low, choice.low * size);
      freed.high = std::min(freed.high, choice.high * size);
    }
    if (choice.role == CandidateParameter::Role::Size) freed.absent = parameter.absent * unit;
    free.push_back(&choice);
    sizes.push_back(size);
  }
  candidate.starts = start_grid(free, sizes, candidate.frees);
  candidate.price = static_cast<int>(free.size());
  candidate.is_exact = entry.is_exact;
  candidate.contains.assign(entry.contains.begin(), entry.contains.end());
  if (entry.waits) candidate.after = candidate.contains;
  candidate.adds.push_back(std::move(added));
  return candidate;
}

bool is_in_model(const Hypothesis& base, std::string_view kind, const std::string& component) {
  return std::any_of(base.terms.begin(), base.terms.end(), [&](const ModelTerm& term) {
    return term.settings.kind == kind && term.component == component;
  });
}

bool is_free(const Hypothesis& base, const std::string& name) {
  return std::any_of(base.free.begin(), base.free.end(),
                     [&](const FreeParameter& free) { return free.name == name; });
}

bool has_loop(const Hypothesis& base, const std::string& component) {
  return std::any_of(base.terms.begin(), base.terms.end(), [&](const ModelTerm& term) {
    return term.component == component && is_hysteretic(term.settings.kind);
  });
}

// What a place offers to terms that need it.
unsigned offered_by(const ConnectionSize& size) {
  return (size.acceleration > 0 ? CandidateTerm::kAcceleration : 0U) |
         (size.has_spring ? CandidateTerm::kSpring : 0U);
}

void add_candidates(Place place, unsigned offered, const TermSite& site, const Hypothesis& base,
                    std::vector<Candidate>& candidates) {
  if (has_loop(base, site.name)) offered |= CandidateTerm::kHysteresis;
  for (const auto& entry : candidate_terms()) {
    if ((entry.places & place) == 0 || (entry.needs & ~offered) != 0) continue;
    if (is_in_model(base, entry.kind, site.name)) continue;
    // The stiffness of a spring is a possible cause of its own.
    if (entry.kind == "linear_stiffness" && (offered & CandidateTerm::kSpring) != 0) continue;
    if (!site.has_time && needs_time(entry)) continue;
    // A fitted linear damper makes a second one redundant.
    if (entry.kind == "viscous_friction" && is_free(base, site.name + ".damping")) continue;
    const bool is_unique = std::none_of(base.terms.begin(), base.terms.end(), [&](const auto& one) {
      return one.settings.kind == entry.kind;
    });
    candidates.push_back(candidate_of(entry, site, site.is_only_one && is_unique));
  }
}

NaturalScale natural_of_signal(const SignalSize& size, double time_step) {
  NaturalScale natural;
  natural.displacement = size.rms;
  natural.velocity = size.rate;
  natural.force = natural.output = size.peak;
  natural.duration = size.peak / size.rate;
  natural.time = time_step;
  return natural;
}

NaturalScale natural_of_connection(const ConnectionSize& size) {
  NaturalScale natural;
  natural.displacement = size.displacement;
  natural.velocity = size.velocity;
  natural.acceleration = size.acceleration;
  natural.force = size.force;
  natural.time = 2 * std::numbers::pi * size.displacement / size.velocity;
  return natural;
}

bool takes_terms(const DynamicModel& model, const std::string& input) {
  return !model.inputs_with_terms || contains(*model.inputs_with_terms, input);
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
    if (parameter.bounds)
      std::tie(candidate.frees[0].low, candidate.frees[0].high) = *parameter.bounds;
    candidate.starts.push_back(VectorXd::Constant(1, parameter.value * 1.02));
  }
  candidate.frees[0].absent = parameter.joins ? 0 : parameter.value;
  candidate.price = 1;
  return candidate;
}

}  // namespace

std::vector<FreeForm> dynamic_forms(const DynamicModel& model, const DynamicSizes& sizes) {
  std::vector<FreeForm> forms;
  for (std::size_t i = 0; i < model.connections.size(); ++i) {
    const ConnectionSize& size = sizes.connections[i];
    if (!(size.displacement > 0 && size.velocity > 0 && size.force > 0)) continue;
    // A drawn law has a dozen parameters, and each of them costs a run.
    if (model.connections[i].is_port) continue;
    for (const auto& kind : kKinds) forms.push_back(form_of(kind, model.connections[i], size));
    forms.push_back(periodic_form(model.connections[i], size));
  }
  return forms;
}

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
    add_candidates(kOnConnection, offered_by(size),
                   {model.connections[i].component,
                    model.connections[i].title,
                    model.connections[i].seen,
                    Part::Structure,
                    sizes.of_connection(size),
                    natural_of_connection(size),
                    model.connections.size() == 1,
                    sizes.has_time,
                    {}},
                   base, candidates);
  }
  const auto add_signals = [&](const std::vector<std::string>& roles,
                               const std::vector<SignalSize>& signal_sizes, Place place,
                               Part part) {
    for (std::size_t i = 0; i < roles.size(); ++i)
      if (signal_sizes[i].peak > 0 && (place != kOnInput || takes_terms(model, roles[i])))
        add_candidates(place, 0,
                       {roles[i],
                        "at " + roles[i],
                        roles[i],
                        part,
                        sizes.of_signal(signal_sizes[i]),
                        natural_of_signal(signal_sizes[i], sizes.time_step),
                        false,
                        sizes.has_time,
                        {signal_sizes[i].unit, signal_sizes[i].unit, "A"}},
                       base, candidates);
  };
  add_signals(model.inputs, sizes.inputs, kOnInput, Part::Actuator);
  add_signals(model.outputs, sizes.outputs, kOnOutput, Part::Sensor);
  for (const auto& parameter : model.parameters)
    if (!parameter.error.empty() && (parameter.value != 0 || parameter.joins) &&
        !is_free(base, parameter.name))
      candidates.push_back(wrong_parameter(parameter, sizes));
  return candidates;
}

}  // namespace rths::diagnosis
