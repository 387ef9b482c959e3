// SPDX-License-Identifier: Apache-2.0
#include "dynamic_simulator.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/identification/vectors.hpp>

#include "dynamic_start.hpp"
#include "dynamic_steps.hpp"

namespace rths::diagnosis {
namespace {

std::vector<sim::TermSettings> terms_at(const Hypothesis& hypothesis,
                                        const std::string& component) {
  std::vector<sim::TermSettings> terms;
  for (const auto& term : hypothesis.terms)
    if (term.component == component) terms.push_back(term.settings);
  return terms;
}

void check_components(const DynamicModel& model, const Hypothesis& hypothesis) {
  for (const auto& term : hypothesis.terms) {
    const auto is_here = [&](const auto& role) { return role == term.component; };
    const bool known =
        std::any_of(model.inputs.begin(), model.inputs.end(), is_here) ||
        std::any_of(model.outputs.begin(), model.outputs.end(), is_here) ||
        std::any_of(model.connections.begin(), model.connections.end(),
                    [&](const Connection& connection) { return is_here(connection.component); });
    if (!known)
      throw Error{fmt::format("term '{}' acts on '{}', which the model does not have",
                              term.settings.kind, term.component)};
  }
}

std::vector<std::optional<ComponentTerms>> chains(const Hypothesis& hypothesis,
                                                  const std::vector<std::string>& roles,
                                                  const std::vector<SignalSize>* signal_sizes,
                                                  const DynamicSizes* sizes, double time_step) {
  std::vector<std::optional<ComponentTerms>> result;
  for (std::size_t i = 0; i < roles.size(); ++i) {
    auto terms = terms_at(hypothesis, roles[i]);
    if (terms.empty()) {
      result.emplace_back();
      continue;
    }
    const UnitScales scales =
        sizes != nullptr ? sizes->of_signal((*signal_sizes)[i]) : UnitScales{};
    result.emplace_back(ComponentTerms{as_chain(std::move(terms)), scales, time_step});
  }
  return result;
}

// Whether terms of a signal bend it between samples: they have no memory, and one is not linear.
bool bends(const Hypothesis& hypothesis, const std::string& role) {
  constexpr std::string_view kBending[] = {"saturation", "input_dead_zone", "absolute_value_sensor",
                                           "cubic_distortion"};
  constexpr std::string_view kLinear[] = {"gain", "offset"};
  const auto is_in = [](const auto& kinds, const sim::TermSettings& term) {
    return std::find(std::begin(kinds), std::end(kinds), term.kind) != std::end(kinds);
  };
  const auto terms = terms_at(hypothesis, role);
  return std::any_of(terms.begin(), terms.end(),
                     [&](const auto& term) { return is_in(kBending, term); }) &&
         std::all_of(terms.begin(), terms.end(), [&](const auto& term) {
           return is_in(kBending, term) || is_in(kLinear, term);
         });
}

}  // namespace

DynamicSimulator::DynamicSimulator(const DynamicModel& model, const Hypothesis& hypothesis,
                                   const DynamicSizes* sizes, double time_step,
                                   const DynamicSignals& signals)
    : model_{model}, signals_{signals} {
  check_components(model, hypothesis);
  setup_.time_step = time_step;
  setup_.plant_inputs = model.plant_inputs;
  bind_model(hypothesis);
  attach_terms(hypothesis, sizes);
  const bool can_divide = model.sampled_every == 0 && system(model.values()).a.rows() > 0;
  if (can_divide) {
    const bool is_smooth = model.hold == Hold::Smooth;
    if (is_smooth) setup_.substeps = 4;
    if (sizes != nullptr)
      setup_.substeps = std::max(setup_.substeps, substeps_needed(hypothesis, *sizes));
    if (model.substeps > 0) setup_.substeps = model.substeps;
    attach_terms(hypothesis, sizes);
  }
  setup_.between = interpolation(model.hold, setup_.substeps);
  for (const auto& role : model.inputs)
    setup_.is_bent.push_back(can_divide && model.hold != Hold::Zero && bends(hypothesis, role));
}

void DynamicSimulator::attach_terms(const Hypothesis& hypothesis, const DynamicSizes* sizes) {
  setup_.inputs = chains(hypothesis, model_.inputs, sizes != nullptr ? &sizes->inputs : nullptr,
                         sizes, setup_.time_step);
  setup_.outputs = chains(hypothesis, model_.outputs, sizes != nullptr ? &sizes->outputs : nullptr,
                          sizes, setup_.time_step);
  attach_to_connections(hypothesis, sizes);
  bind_terms(hypothesis);
}

void DynamicSimulator::attach_to_connections(const Hypothesis& hypothesis,
                                             const DynamicSizes* sizes) {
  setup_.connections.clear();
  for (std::size_t i = 0; i < model_.connections.size(); ++i) {
    auto terms = terms_at(hypothesis, model_.connections[i].component);
    if (terms.empty() && sizes != nullptr) continue;
    auto connection = as_connection(std::move(terms));
    const UnitScales scales =
        sizes != nullptr ? sizes->of_connection(sizes->connections[i]) : UnitScales{};
    setup_.connections.push_back(
        {i, ComponentTerms{connection.terms, scales, setup_.time_step / setup_.substeps},
         connection.holds_linear});
  }
}

ComponentTerms* DynamicSimulator::terms_of(const std::string& component) {
  for (std::size_t i = 0; i < model_.inputs.size(); ++i)
    if (model_.inputs[i] == component) return &*setup_.inputs[i];
  for (std::size_t i = 0; i < model_.outputs.size(); ++i)
    if (model_.outputs[i] == component) return &*setup_.outputs[i];
  for (auto& connection : setup_.connections)
    if (model_.connections[connection.connection].component == component) return &connection.terms;
  return nullptr;
}

void DynamicSimulator::bind_terms(const Hypothesis& hypothesis) {
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const auto at = find_parameter(model_, hypothesis.terms, hypothesis.free[i].name);
    if (at.of_model) continue;
    const auto& [settings, component] = hypothesis.terms[at.term];
    terms_of(component)->bind(settings.name.empty() ? settings.kind : settings.name, at.parameter,
                              static_cast<Index>(i));
  }
}

void DynamicSimulator::bind_model(const Hypothesis& hypothesis) {
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const auto at = find_parameter(model_, hypothesis.terms, hypothesis.free[i].name);
    if (at.of_model)
      bound_.push_back(
          {static_cast<Index>(i), static_cast<Index>(*at.of_model), hypothesis.free[i].scale});
  }
}

// A substep resolves the third harmonic of the motion, and the oscillation on a term's largest
// secant stiffness.
int DynamicSimulator::substeps_needed(const Hypothesis& hypothesis,
                                      const DynamicSizes& sizes) const {
  constexpr double kLongest = 0.5;   // for the oscillation [rad]
  constexpr double kHarmonic = 0.4;  // for the third harmonic [rad]
  constexpr int kMost = 64;
  const LinearSystem linear = system(plant_values(hypothesis.values));
  const auto values = plain(hypothesis.values);
  double fastest = 0;   // squared [rad²/s²]
  double harmonic = 0;  // [rad/s]
  for (std::size_t c = 0; c < setup_.connections.size(); ++c) {
    const ComponentTerms& terms = setup_.connections[c].terms;
    const auto parameters = terms.parameters(values);
    const auto i = static_cast<Index>(c);
    const double mobility = std::abs((linear.r * linear.e)(i, i));
    const ConnectionSize& size = sizes.connections[setup_.connections[c].connection];
    const double reach = size.displacement;
    if (reach > 0) harmonic = std::max(harmonic, 3 * size.velocity / reach);
    for (double way = 1e-4 * reach; way <= reach; way *= 10) {
      std::vector<double> state(terms.composition().states());
      sim::Quantities<double> q;
      q.displacement[0] = way / terms.scales().length;
      terms.composition().advance(parameters, state, q);
      fastest = std::max(fastest, mobility * std::abs(q.force[0]) * terms.scales().force / way);
    }
  }
  int substeps = 1;
  const double needed =
      setup_.time_step * std::max(std::sqrt(fastest) / kLongest, harmonic / kHarmonic);
  while (substeps < kMost && needed > substeps) substeps *= 2;
  return substeps;
}

VectorXd DynamicSimulator::plant_values(const VectorXd& values) const {
  VectorXd plant = model_.values();
  for (const auto& [free, parameter, scale] : bound_) plant[parameter] = values[free];
  return plant;
}

// With only the connections that have terms.
LinearSystem DynamicSimulator::system(const VectorXd& plant) const {
  LinearSystem all = model_.linear(plant);
  LinearSystem chosen = all;
  const auto count = static_cast<Index>(setup_.connections.size());
  const auto resized_columns = [&](const MatrixXd& from, MatrixXd& to) {
    to.resize(from.rows(), count);
    for (Index i = 0; i < count; ++i)
      to.col(i) =
          from.col(static_cast<Index>(setup_.connections[static_cast<std::size_t>(i)].connection));
  };
  const auto resized_rows = [&](const MatrixXd& from, auto& to) {
    to.resize(count, from.cols());
    for (Index i = 0; i < count; ++i)
      to.row(i) =
          from.row(static_cast<Index>(setup_.connections[static_cast<std::size_t>(i)].connection));
  };
  resized_columns(all.e, chosen.e);
  resized_columns(all.h, chosen.h);
  resized_rows(all.p, chosen.p);
  resized_rows(all.q, chosen.q);
  resized_rows(all.r, chosen.r);
  resized_rows(all.s, chosen.s);
  resized_rows(all.t, chosen.t);
  resized_rows(all.stiffness, chosen.stiffness);
  resized_rows(all.damping, chosen.damping);
  return chosen;
}

StepMatrices<double> DynamicSimulator::steps(const VectorXd& plant) const {
  return step_matrices(system(plant), setup_.time_step / setup_.substeps, model_.sampled_every > 0);
}

VectorXd DynamicSimulator::start(const VectorXd& values, const StepMatrices<double>& linear) const {
  DynamicSignals first = signals_;
  for (auto& input : first.inputs)
    input.resize(std::min(input.size(), static_cast<std::size_t>(signals_.beginning.rows())));
  return fitted_start(linear, setup_.substeps, signals_.beginning, signals_.start_state,
                      [&](const VectorXd& state) {
                        first.start_state = state;
                        const auto outputs = run_freely(setup_, first, linear, plain(values));
                        return outputs.empty() ? MatrixXd{} : as_columns(outputs);
                      });
}

std::vector<double> DynamicSimulator::driven(std::size_t input, const VectorXd& values) const {
  std::vector<double> signal = signals_.inputs[input];
  if (setup_.inputs[input]) pass(*setup_.inputs[input], plain(values), signals_.start, signal);
  return signal;
}

std::vector<std::vector<double>> DynamicSimulator::motion(const VectorXd& values) const {
  std::vector<std::vector<double>> result;
  const auto outputs =
      run_freely(setup_, signals_, steps(plant_values(values)), plain(values), &result);
  return outputs.empty() ? std::vector<std::vector<double>>{} : result;
}

}  // namespace rths::diagnosis
