// SPDX-License-Identifier: Apache-2.0
#include "foreign_simulator.hpp"

#include <algorithm>

#include <rths/core/text.hpp>

namespace rths::diagnosis {

ForeignSimulator::ForeignSimulator(const DynamicModel& model, const ForeignModel& foreign,
                                   const Hypothesis& hypothesis, const DynamicSizes& sizes,
                                   double time_step, const DynamicSignals& signals)
    : model_{model},
      foreign_{foreign},
      free_{hypothesis.free},
      time_step_{time_step},
      signals_{signals},
      outputs_{model, hypothesis, &sizes, time_step, signals_} {
  for (const auto& role : foreign.inputs())
    inputs_.push_back(static_cast<std::size_t>(
        std::find(model.inputs.begin(), model.inputs.end(), role) - model.inputs.begin()));
  for (const auto& free : free_) {
    const auto at = find_parameter(model, hypothesis.terms, free.name);
    parameter_.push_back(at.of_model);
    is_upstream_.push_back(at.of_model ||
                           contains(foreign.inputs(), hypothesis.terms[at.term].component));
  }
}

foreign::RunInputs ForeignSimulator::run_at(const VectorXd& values) const {
  foreign::RunInputs run{signals_.start, time_step_, signals_.inputs.front().size(), {}, {}};
  for (const std::size_t input : inputs_) run.inputs.push_back(outputs_.driven(input, values));
  for (const auto& parameter : model_.parameters) run.parameters.push_back(parameter.value);
  for (std::size_t i = 0; i < parameter_.size(); ++i)
    if (parameter_[i]) run.parameters[*parameter_[i]] = values[static_cast<Index>(i)];
  return run;
}

bool ForeignSimulator::take(const foreign::RunOutputs& run) const {
  if (!run.trouble.empty()) return false;
  // The predictions are the first inputs of the model.
  std::vector<std::size_t> at;
  for (const auto& role : foreign_.outputs())
    at.push_back(static_cast<std::size_t>(
        std::find(model_.outputs.begin(), model_.outputs.end(), role) - model_.outputs.begin()));
  for (std::size_t i = 0; i < at.size(); ++i) signals_.inputs[at[i]] = run.outputs[i];
  return true;
}

double ForeignSimulator::step_of(Index free, const VectorXd& values) const {
  constexpr double kStep = 1e-2;  // of the scale
  const auto i = static_cast<std::size_t>(free);
  double step = kStep * free_[i].scale;
  if (parameter_[i] && model_.parameters[*parameter_[i]].step > 0)
    step = model_.parameters[*parameter_[i]].step;
  return values[free] + step > free_[i].high ? -step : step;
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
    points.back()[i] += step_of(i, values);
  }
  for (const auto& point : points) runs.push_back(run_at(point));
  const auto results = foreign_.results(runs);
  std::vector<MatrixXd> of_terms;
  if (!take(*results[0]) || !outputs_.run(values, downstream, prediction, of_terms)) return false;
  derivatives.assign(wanted.size(), {});
  const auto place_of = [&](Index free) {
    return static_cast<std::size_t>(std::find(wanted.begin(), wanted.end(), free) - wanted.begin());
  };
  for (std::size_t i = 0; i < downstream.size(); ++i)
    derivatives[place_of(downstream[i])] = std::move(of_terms[i]);
  for (std::size_t i = 0; i < upstream.size(); ++i) {
    MatrixXd beside;
    const VectorXd& point = points[i + 1];
    if (!take(*results[i + 1]) || !outputs_.run(point, {}, beside, of_terms)) return false;
    derivatives[place_of(upstream[i])] =
        (beside - prediction) / (point[upstream[i]] - values[upstream[i]]);
  }
  return true;
}

}  // namespace rths::diagnosis
