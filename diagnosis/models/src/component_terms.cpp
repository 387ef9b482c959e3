// SPDX-License-Identifier: Apache-2.0
#include "component_terms.hpp"

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

constexpr std::string_view kSignal = "the signal";
constexpr unsigned kAlong = 0b01;

sim::TermSettings on_one_axis(sim::TermSettings term) {
  const sim::TermKind& kind = sim::term_kind(term.kind);
  if ((kind.traits & sim::kPerAxis) != 0) term.axes = kAlong;
  term.channel = sim::SensorChannel::Force;
  return term;
}

template <class Real>
void pass_through(const ComponentTerms& chain, const std::vector<Real>& values, double start,
                  std::vector<Real>& signal) {
  const auto& composition = chain.composition();
  const std::vector<Real> parameters = chain.parameters(values);
  std::vector<Real> state(composition.states());
  const double size = chain.scales().length, into = 1 / size;
  sim::Quantities<Real> q;
  for (std::size_t i = 0; i < signal.size(); ++i) {
    q = {};
    q.time = start / chain.scales().time + static_cast<double>(i) * composition.time_step();
    q.displacement[0] = signal[i] * into;
    composition.advance(parameters, state, q);
    signal[i] = q.force[0] * size;
  }
}

}  // namespace

ComponentTerms::ComponentTerms(const std::vector<sim::TermSettings>& terms,
                               const UnitScales& scales, double time_step)
    : scales_{scales} {
  std::vector<sim::TermSettings> scaled;
  for (const auto& term : terms) scaled.push_back(in_units(term, scales));
  composition_ = sim::Composition{scaled, time_step / scales.time};
}

void ComponentTerms::bind(const std::string& term, const std::string& parameter, Index free) {
  const std::size_t index = composition_.parameter_index(term, parameter);
  for (const auto& candidate : composition_.terms())
    if (candidate.name == term)
      free_.push_back({index, free, scales_.of(parameter_of(*candidate.kind, parameter).unit)});
}

void pass(const ComponentTerms& chain, const std::vector<double>& values, double start,
          std::vector<double>& signal) {
  pass_through(chain, values, start, signal);
}
void pass(const ComponentTerms& chain, const std::vector<sim::Dual>& values, double start,
          std::vector<sim::Dual>& signal) {
  pass_through(chain, values, start, signal);
}

std::vector<sim::TermSettings> as_chain(std::vector<sim::TermSettings> terms) {
  for (auto& term : terms) {
    const sim::Stage stage = sim::term_kind(term.kind).stage;
    if (stage != sim::Stage::Actuator && stage != sim::Stage::Motion && stage != sim::Stage::Sensor)
      throw Error{fmt::format(
          "'{}' is a force; a signal takes terms of the stages actuator, motion and sensor",
          term.kind)};
    term = on_one_axis(std::move(term));
  }
  sim::TermSettings signal{"polynomial_stiffness", std::string{kSignal}, {{"linear", 1.0}}};
  terms.push_back(on_one_axis(std::move(signal)));
  return terms;
}

ConnectionTerms as_connection(std::vector<sim::TermSettings> terms) {
  ConnectionTerms result;
  for (auto& term : terms) {
    const sim::Stage stage = sim::term_kind(term.kind).stage;
    if (stage == sim::Stage::Actuator || stage == sim::Stage::Sensor ||
        stage == sim::Stage::Vertical)
      throw Error{
          fmt::format("'{}' is not a force between two points; a connection takes terms of the "
                      "stages motion, modifier, restoring and machine",
                      term.kind)};
    result.holds_linear |= stage == sim::Stage::Motion;
    term = on_one_axis(std::move(term));
  }
  if (result.holds_linear) {
    terms.push_back(on_one_axis({"polynomial_stiffness", std::string{kLinearSpring}, {}}));
    terms.push_back({"viscous_damping", std::string{kLinearDamper}, {}});
  }
  result.terms = std::move(terms);
  return result;
}

}  // namespace rths::diagnosis
