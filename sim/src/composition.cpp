// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/composition.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

// The first states of a composition hold the hysteretic force and the specimen's force of the
// previous step.
constexpr std::size_t kSharedStates = std::size_t{2} * kHorizontalAxes;

std::size_t index_of_parameter(const TermKind& kind, const std::string& name) {
  return static_cast<std::size_t>(&parameter_of(kind, name) - kind.parameters.data());
}

std::vector<double> parameters_of(const TermKind& kind, const TermSettings& settings) {
  std::vector<double> values;
  for (const auto& parameter : kind.parameters) values.push_back(parameter.absent);
  for (const auto& [name, value] : settings.parameters) {
    const std::size_t i = index_of_parameter(kind, name);
    const Parameter& parameter = kind.parameters[i];
    if (!(value >= parameter.low && value <= parameter.high))
      throw Error{fmt::format("term '{}': {} is {}, expected {} to {}", name_of(settings),
                              parameter_key(parameter, settings.channel), value, parameter.low,
                              parameter.high)};
    values[i] = value;
  }
  return values;
}

void check(const TermKind& kind, const TermSettings& settings) {
  if (settings.axes == 0 || settings.axes > kBothAxes)
    throw Error{
        fmt::format("term '{}' acts on no axis, expected long, lat or both", name_of(settings))};
  if (settings.axes != kBothAxes && (kind.traits & kPerAxis) == 0)
    throw Error{
        fmt::format("term '{}' couples both axes; it cannot be limited to one", name_of(settings))};
  if (settings.channel != SensorChannel::Force && (kind.traits & kPerChannel) == 0)
    throw Error{
        fmt::format("term '{}' is not a sensor term; it has no channel", name_of(settings))};
  if (settings.channel == SensorChannel::AxialLoad &&
      (settings.axes != kBothAxes || (kind.traits & kPerAxis) == 0))
    throw Error{fmt::format("term '{}' acts on single axes, but the axial load has none",
                            name_of(settings))};
}

template <class Real>
struct HorizontalMotion {
  Horizontal<Real> displacement, velocity, acceleration;
};

template <class Real>
void run(const Composition& composition, std::span<const double> constants, const Real* parameters,
         std::span<Real> state, Quantities<Real>& q) noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    q.last_hysteretic_force[i] = state[i];
    q.last_specimen_force[i] = state[kHorizontalAxes + i];
  }
  const auto terms = composition.terms();
  auto term = terms.begin();
  const auto advance_through = [&](Stage last) {
    for (; term != terms.end() && term->kind->stage <= last; ++term) {
      const TermView<Real> view{parameters + term->first_parameter,
                                constants.data() + term->first_constant,
                                state.data() + term->first_state,
                                composition.time_step(),
                                term->axes,
                                term->channel};
      if constexpr (std::is_same_v<Real, double>)
        term->kind->step(view, q);
      else
        term->kind->step_dual(view, q);
    }
  };
  advance_through(Stage::Actuator);
  // Only a mount moves the specimen otherwise than the platen; a copy would cost as much as a term.
  std::optional<HorizontalMotion<Real>> platen;
  if (term != terms.end() && term->kind->stage == Stage::Motion)
    platen.emplace(HorizontalMotion<Real>{q.displacement, q.velocity, q.acceleration});
  advance_through(Stage::Restoring);
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    state[i] = q.hysteretic_force[i];
    state[kHorizontalAxes + i] = q.force[i];
  }
  if (platen) {
    q.displacement = platen->displacement;
    q.velocity = platen->velocity;
    q.acceleration = platen->acceleration;
  }
  advance_through(Stage::Sensor);
}

}  // namespace

const std::string& name_of(const TermSettings& settings) {
  return settings.name.empty() ? settings.kind : settings.name;
}

Composition::Composition(const std::vector<TermSettings>& settings, double time_step)
    : time_step_{time_step}, states_{kSharedStates} {
  if (!(time_step > 0) || !std::isfinite(time_step))
    throw Error{
        fmt::format("time step of a composition is {}, expected a positive number", time_step)};
  struct Wanted {
    const TermKind* kind;
    const TermSettings* settings;
  };
  std::vector<Wanted> wanted;
  std::set<std::string> names;
  for (const auto& term : settings) {
    wanted.push_back({&term_kind(term.kind), &term});
    check(*wanted.back().kind, term);
    if (!names.insert(name_of(term)).second)
      throw Error{fmt::format("two terms have the name '{}'", name_of(term))};
  }
  std::stable_sort(wanted.begin(), wanted.end(),
                   [](const auto& a, const auto& b) { return a.kind < b.kind; });
  for (const auto& [kind, term] : wanted) {
    const auto values = parameters_of(*kind, *term);
    const TermSetup setup{values, kind->parameters, time_step};
    const TermSize size = kind->size(setup);
    terms_.push_back({kind, name_of(*term), term->axes, term->channel, parameters_.size(), states_,
                      constants_.size()});
    parameters_.insert(parameters_.end(), values.begin(), values.end());
    constants_.resize(constants_.size() + size.constants);
    states_ += size.states;
    kind->prepare(setup, std::span{constants_}.last(size.constants));
  }
}

std::size_t Composition::parameter_index(const std::string& term,
                                         const std::string& parameter) const {
  for (const auto& candidate : terms_)
    if (candidate.name == term)
      return candidate.first_parameter + index_of_parameter(*candidate.kind, parameter);
  throw Error{fmt::format("there is no term '{}' in this composition", term)};
}

void Composition::set_specimen_force(std::span<double> state,
                                     const Horizontal<double>& force) const noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) state[kHorizontalAxes + i] = force[i];
}

void Composition::set_specimen_force(std::span<Dual> state,
                                     const Horizontal<double>& force) const noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) state[kHorizontalAxes + i] = force[i];
}

void Composition::advance(std::span<const double> parameters, std::span<double> state,
                          Quantities<double>& q) const noexcept {
  run(*this, constants_, parameters.data(), state, q);
}

void Composition::advance(std::span<const Dual> parameters, std::span<Dual> state,
                          Quantities<Dual>& q) const noexcept {
  run(*this, constants_, parameters.data(), state, q);
}

}  // namespace rths::sim
