// SPDX-License-Identifier: Apache-2.0
// Predictions of a dynamic model, and their derivatives with respect to its free parameters.
#include <algorithm>
#include <cmath>

#include "dynamic_simulator.hpp"
#include "dynamic_start.hpp"

namespace rths::diagnosis {

using sim::Dual;

namespace {

constexpr double kDifference = 1e-5;  // relative step of a parameter of the linear system

// Returns whether all numbers are finite.
bool split_duals(const std::vector<std::vector<Dual>>& outputs, MatrixXd& prediction,
                 std::vector<MatrixXd>& derivatives) {
  prediction.resize(static_cast<Index>(outputs[0].size()), static_cast<Index>(outputs.size()));
  for (auto& derivative : derivatives) derivative.resize(prediction.rows(), prediction.cols());
  bool finite = true;
  for (Index j = 0; j < prediction.cols(); ++j)
    for (Index i = 0; i < prediction.rows(); ++i) {
      const Dual& y = outputs[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)];
      prediction(i, j) = y.value;
      finite &= std::isfinite(y.value);
      for (std::size_t lane = 0; lane < derivatives.size(); ++lane) {
        derivatives[lane](i, j) = y.derivative[lane];
        finite &= std::isfinite(y.derivative[lane]);
      }
    }
  return finite;
}

}  // namespace

std::vector<double> plain(const VectorXd& values) { return {values.begin(), values.end()}; }

MatrixXd as_columns(const std::vector<std::vector<double>>& outputs) {
  MatrixXd matrix(outputs[0].size(), outputs.size());
  for (Index i = 0; i < matrix.cols(); ++i)
    matrix.col(i) = VectorXd::Map(outputs[static_cast<std::size_t>(i)].data(), matrix.rows());
  return matrix;
}

bool DynamicSimulator::run(const VectorXd& values, const std::vector<Index>& wanted,
                           MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const {
  const StepMatrices<double> plain_steps = steps(plant_values(values));
  if (!has_free_start())
    return run_from(signals_, values, wanted, plain_steps, prediction, derivatives);
  DynamicSignals signals = signals_;
  signals.start_state = start(values, plain_steps);
  if (!run_from(signals, values, wanted, plain_steps, prediction, derivatives)) return false;
  if (wanted.empty() || signals.start_state.size() == 0) return true;
  const auto response = start_response(signals, values, plain_steps, prediction);
  if (response.empty()) return false;
  follow_start(signals_.beginning.rows(), response, derivatives);
  return true;
}

std::vector<MatrixXd> DynamicSimulator::start_response(DynamicSignals signals,
                                                       const VectorXd& values,
                                                       const StepMatrices<double>& plain_steps,
                                                       const MatrixXd& prediction) const {
  std::vector<MatrixXd> response;
  const VectorXd sizes = state_sizes(plain_steps, setup_.substeps, signals.beginning);
  for (Index i = 0; i < sizes.size(); ++i) {
    const double state = signals.start_state[i], step = kDifference * sizes[i];
    signals.start_state[i] = state + step;
    const auto outputs = run_freely(setup_, signals, plain_steps, plain(values));
    signals.start_state[i] = state;
    if (outputs.empty()) return {};
    response.emplace_back(step > 0 ? MatrixXd{(as_columns(outputs) - prediction) / step}
                                   : MatrixXd::Zero(prediction.rows(), prediction.cols()));
  }
  return response;
}

bool DynamicSimulator::run_from(const DynamicSignals& signals, const VectorXd& values,
                                const std::vector<Index>& wanted,
                                const StepMatrices<double>& plain_steps, MatrixXd& prediction,
                                std::vector<MatrixXd>& derivatives) const {
  derivatives.assign(wanted.size(), {});
  if (wanted.empty()) {
    const auto outputs = run_freely(setup_, signals, plain_steps, plain(values));
    if (outputs.empty()) return false;
    prediction = as_columns(outputs);
    return prediction.allFinite();
  }
  for (std::size_t first = 0; first < wanted.size(); first += Dual::kLanes) {
    const std::size_t end = std::min(first + Dual::kLanes, wanted.size());
    std::vector<MatrixXd> some(end - first);
    if (!run_lanes(signals, values,
                   {wanted.begin() + static_cast<std::ptrdiff_t>(first),
                    wanted.begin() + static_cast<std::ptrdiff_t>(end)},
                   plain_steps, prediction, some))
      return false;
    std::move(some.begin(), some.end(), derivatives.begin() + static_cast<std::ptrdiff_t>(first));
  }
  return true;
}

// Whether these parameters belong to terms at the outputs.
bool DynamicSimulator::only_at_outputs(const std::vector<Index>& lanes) const {
  const auto follows_any = [&](const ComponentTerms& terms) {
    return std::any_of(terms.free().begin(), terms.free().end(), [&](const auto& bound) {
      return std::find(lanes.begin(), lanes.end(), bound.free) != lanes.end();
    });
  };
  return std::none_of(setup_.inputs.begin(), setup_.inputs.end(),
                      [&](const auto& chain) { return chain && follows_any(*chain); }) &&
         std::none_of(setup_.connections.begin(), setup_.connections.end(),
                      [&](const auto& connection) { return follows_any(connection.terms); });
}

bool DynamicSimulator::run_lanes(const DynamicSignals& signals, const VectorXd& values,
                                 const std::vector<Index>& lanes,
                                 const StepMatrices<double>& plain_steps, MatrixXd& prediction,
                                 std::vector<MatrixXd>& derivatives) const {
  std::vector<Dual> duals(values.begin(), values.end());
  std::vector<LaneMatrices> differences;
  for (std::size_t lane = 0; lane < lanes.size(); ++lane) {
    duals[static_cast<std::size_t>(lanes[lane])].derivative[lane] = 1;
    for (const auto& [free, parameter, scale] : bound_) {
      if (free != lanes[lane]) continue;
      VectorXd above = plant_values(values), below = above;
      const double distance = kDifference * std::max(std::abs(above[parameter]), scale);
      above[parameter] += distance;
      below[parameter] -= distance;
      differences.push_back({lane, steps(above), steps(below), 2 * distance});
    }
  }
  const auto outputs =
      differences.empty()
          ? only_at_outputs(lanes) ? through_outputs(setup_, signals, plain_steps, duals)
                                   : run_freely(setup_, signals, plain_steps, duals)
          : run_freely(setup_, signals, with_lanes(plain_steps, differences), duals);
  return !outputs.empty() && split_duals(outputs, prediction, derivatives);
}

}  // namespace rths::diagnosis
