// SPDX-License-Identifier: Apache-2.0
#include "foreign_simulator.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "connection_force.hpp"

namespace rths::diagnosis {
namespace {

/// Terms at the ports of a simulation, one connection for each.
class TermForces final : public foreign::PortForces {
 public:
  TermForces(std::vector<ConnectionWithTerms> ports, const std::vector<double>& values)
      : ports_{std::move(ports)} {
    for (const auto& port : ports_) forces_.emplace_back(port, values, 0.0, 0.0);
  }
  double next(std::size_t port, const foreign::PortMotion& motion) override {
    const double force =
        forces_[port].trial(motion.displacement, motion.velocity, 0.0, motion.time);
    forces_[port].commit();
    return force;
  }

 private:
  std::vector<ConnectionWithTerms> ports_;
  std::vector<ConnectionForce<double>> forces_;  // of ports_
};

// The connection of a port with its terms.
ConnectionWithTerms connection_of(const DynamicModel& model, const Hypothesis& hypothesis,
                                  const DynamicSizes& sizes, const std::string& component,
                                  double time_step) {
  const auto at = std::find_if(model.connections.begin(), model.connections.end(),
                               [&](const auto& one) { return one.component == component; });
  const auto index = static_cast<std::size_t>(at - model.connections.begin());
  std::vector<sim::TermSettings> terms;
  for (const auto& term : hypothesis.terms)
    if (term.component == component) terms.push_back(term.settings);
  const auto found = as_connection(std::move(terms));
  ConnectionWithTerms connection{
      index, {found.terms, sizes.of_connection(sizes.connections[index]), time_step}, false};
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const auto free = find_parameter(model, hypothesis.terms, hypothesis.free[i].name);
    if (free.of_model || hypothesis.terms[free.term].component != component) continue;
    connection.terms.bind(sim::name_of(hypothesis.terms[free.term].settings), free.parameter,
                          static_cast<Index>(i));
  }
  return connection;
}

bool is_port(const ForeignModel& foreign, const std::string& component) {
  return std::any_of(foreign.ports().begin(), foreign.ports().end(),
                     [&](const auto& port) { return port.component == component; });
}

}  // namespace

ForeignSimulator::ForeignSimulator(const DynamicModel& model, const ForeignModel& foreign,
                                   const Hypothesis& hypothesis, const DynamicSizes& sizes,
                                   double time_step, const DynamicSignals& signals)
    : model_{model},
      foreign_{foreign},
      hypothesis_{hypothesis},
      sizes_{sizes},
      free_{hypothesis.free},
      time_step_{time_step},
      signals_{signals},
      outputs_{model, hypothesis, &sizes_, time_step, signals_} {
  const auto place_of = [&](const std::string& role) {
    return static_cast<std::size_t>(std::find(model.inputs.begin(), model.inputs.end(), role) -
                                    model.inputs.begin());
  };
  for (const auto& role : foreign.inputs()) inputs_.push_back(place_of(role));
  for (const auto& role : foreign.computed()) computed_.push_back(place_of(role));
  for (const auto& free : free_) {
    const auto at = find_parameter(model, hypothesis.terms, free.name);
    parameter_.push_back(at.of_model);
    is_upstream_.push_back(at.of_model ||
                           contains(foreign.inputs(), hypothesis.terms[at.term].component) ||
                           is_port(foreign, hypothesis.terms[at.term].component));
  }
}

foreign::RunInputs ForeignSimulator::run_at(const VectorXd& values) const {
  foreign::RunInputs run{signals_.start, time_step_, signals_.inputs.front().size(), {}, {},
                         law_at(values)};
  for (const std::size_t input : inputs_) run.inputs.push_back(outputs_.driven(input, values));
  for (const auto& parameter : model_.parameters) run.parameters.push_back(parameter.value);
  for (std::size_t i = 0; i < parameter_.size(); ++i)
    if (parameter_[i]) run.parameters[*parameter_[i]] = values[static_cast<Index>(i)];
  return run;
}

foreign::PortLaw ForeignSimulator::law_at(const VectorXd& values) const {
  foreign::PortLaw law;
  for (const auto& [settings, component] : hypothesis_.terms) {
    if (!is_port(foreign_, component)) continue;
    law.key += fmt::format("{} {} {}", component, settings.kind, sim::name_of(settings));
    for (const auto& [name, value] : settings.parameters)
      law.key += fmt::format(" {} {}", name, value);
  }
  if (law.key.empty()) return law;
  for (std::size_t i = 0; i < free_.size(); ++i)
    if (is_upstream_[i] && !parameter_[i])
      law.key += fmt::format(" {} {}", free_[i].name, values[static_cast<Index>(i)]);
  law.begin = [this, values = plain(values)](double time_step) {
    std::vector<ConnectionWithTerms> ports;
    for (const auto& port : foreign_.ports())
      ports.push_back(connection_of(model_, hypothesis_, sizes_, port.component, time_step));
    return std::make_unique<TermForces>(std::move(ports), values);
  };
  return law;
}

bool ForeignSimulator::take(const foreign::RunOutputs& run) const {
  if (!run.trouble.empty()) return false;
  for (std::size_t i = 0; i < computed_.size(); ++i) signals_.inputs[computed_[i]] = run.outputs[i];
  return true;
}

double ForeignSimulator::step_of(Index free, const VectorXd& values, double growth) const {
  constexpr double kStep = 1e-2;  // of the scale
  const auto i = static_cast<std::size_t>(free);
  double step = kStep * free_[i].scale;
  if (parameter_[i] && model_.parameters[*parameter_[i]].step > 0)
    step = model_.parameters[*parameter_[i]].step;
  step = std::min(step * growth, 0.5 * (free_[i].high - free_[i].low));
  return values[free] + step > free_[i].high ? -step : step;
}

std::optional<MatrixXd> ForeignSimulator::slope(Index free, const VectorXd& values, double growth,
                                                const MatrixXd& prediction) const {
  VectorXd point = values;
  point[free] += step_of(free, values, growth);
  MatrixXd beside;
  std::vector<MatrixXd> none;
  if (!take(foreign_.results({run_at(point)})[0]) || !outputs_.run(point, {}, beside, none))
    return std::nullopt;
  return (beside - prediction) / (point[free] - values[free]);
}

double ForeignSimulator::growth_of(Index free, const VectorXd& values,
                                   const MatrixXd& prediction) const {
  constexpr double kChange = 0.03;                // of an output, where it is linear but for events
  constexpr double kToScale = 100, kMost = 1000;  // growth
  const auto i = static_cast<std::size_t>(free);
  if (const auto known = foreign_.growth_of(free_[i].name)) return *known;
  double growth = 1;
  const bool is_stated = parameter_[i] && model_.parameters[*parameter_[i]].step > 0;
  if (const auto found = slope(free, values, growth, prediction); found && !is_stated) {
    double change = 0;
    for (Index k = 0; k < prediction.cols(); ++k)
      if (const double size = prediction.col(k).norm(); size > 0)
        change = std::max(change, found->col(k).norm() / size);
    change *= std::abs(step_of(free, values, growth));
    growth = change > 0 ? std::clamp(kChange / change, 1.0, kMost) : kToScale;
  }
  foreign_.keep_growth(free_[i].name, growth);
  return growth;
}

bool ForeignSimulator::run(const VectorXd& values, const std::vector<Index>& wanted,
                           MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const {
  std::vector<Index> upstream, downstream;
  for (const Index i : wanted)
    (is_upstream_[static_cast<std::size_t>(i)] ? upstream : downstream).push_back(i);
  std::vector<VectorXd> points{values};
  std::vector<foreign::RunInputs> runs;
  for (const Index i : upstream) {
    points.push_back(values);
    points.back()[i] +=
        step_of(i, values, foreign_.growth_of(free_[static_cast<std::size_t>(i)].name).value_or(1));
  }
  for (const auto& point : points) runs.push_back(run_at(point));
  const auto results = foreign_.results(runs);
  std::vector<MatrixXd> of_terms;
  if (!take(results[0]) || !outputs_.run(values, downstream, prediction, of_terms)) return false;
  derivatives.assign(wanted.size(), {});
  const auto place_of = [&](Index free) {
    return static_cast<std::size_t>(std::find(wanted.begin(), wanted.end(), free) - wanted.begin());
  };
  for (std::size_t i = 0; i < downstream.size(); ++i)
    derivatives[place_of(downstream[i])] = std::move(of_terms[i]);
  // Their runs are known, unless a parameter moves for the first time.
  for (const Index i : upstream) {
    auto found = slope(i, values, growth_of(i, values, prediction), prediction);
    if (!found) found = slope(i, values, 1, prediction);  // as far as the simulation goes
    if (!found) return false;
    derivatives[place_of(i)] = *std::move(found);
  }
  return true;
}

}  // namespace rths::diagnosis
