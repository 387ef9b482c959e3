// SPDX-License-Identifier: Apache-2.0
// Parameter recovery for every term: least squares on its noisy output returns its parameters, and
// the intervals have their nominal coverage.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Core>

#include <rths/maths/decompositions.hpp>
#include <rths/sim/composition.hpp>

#include "sim/term_cases.hpp"
#include "support/long_run.hpp"

namespace rths::sim {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// A 95 % interval covers 6 of 10 or fewer with a probability of 1/1000.
struct Trials {
  int seeds, enough;
};
// P(83 or fewer of 100 | 0.95) = 9e-6, for each of the 244 parameters of all kinds.
Trials trials() { return test::is_long() ? Trials{100, 84} : Trials{10, 7}; }
constexpr int kIterations = 60;
constexpr double kNormalQuantile = 1.959964;  // two-sided 95 %

struct Problem {
  Composition composition;
  test_support::Motion motion;
  std::vector<std::size_t> free;  // indices into parameters()
  std::vector<Parameter> table;   // of the free ones
  VectorXd truth;
  VectorXd weight;  // of each output: 1/noise, or 0 for an output without noise
};

Problem problem_of(const test_support::TermCase& c) {
  Problem problem{test_support::composition_of(c), c.motion, {}, {}, {}, {}};
  for (const auto& term : problem.composition.terms()) {
    if (term.name != "tested") continue;
    for (std::size_t k = 0; k < term.kind->parameters.size(); ++k) {
      const Parameter& parameter = term.kind->parameters[k];
      if (std::find(c.fixed.begin(), c.fixed.end(), parameter.name) != c.fixed.end()) continue;
      problem.free.push_back(term.first_parameter + k);
      problem.table.push_back(parameter);
    }
  }
  problem.truth.resize(static_cast<Eigen::Index>(problem.free.size()));
  for (std::size_t j = 0; j < problem.free.size(); ++j)
    problem.truth[static_cast<Eigen::Index>(j)] = problem.composition.parameters()[problem.free[j]];
  return problem;
}

std::vector<double> parameters_with(const Problem& problem, const VectorXd& values) {
  const auto p = problem.composition.parameters();
  std::vector<double> parameters(p.begin(), p.end());
  for (std::size_t j = 0; j < problem.free.size(); ++j)
    parameters[problem.free[j]] = values[static_cast<Eigen::Index>(j)];
  return parameters;
}

VectorXd predict(const Problem& problem, const VectorXd& values) {
  const auto outputs = test_support::outputs_of<double>(
      problem.composition, parameters_with(problem, values), problem.motion);
  return Eigen::Map<const VectorXd>(outputs.data(), static_cast<Eigen::Index>(outputs.size()));
}

MatrixXd jacobian(const Problem& problem, const VectorXd& values) {
  MatrixXd J(static_cast<Eigen::Index>(problem.motion.steps) * test_support::kOutputs,
             values.size());
  const auto plain = parameters_with(problem, values);
  for (std::size_t first = 0; first < problem.free.size(); first += Dual::kLanes) {
    std::vector<Dual> duals(plain.begin(), plain.end());
    const std::size_t lanes = std::min(Dual::kLanes, problem.free.size() - first);
    for (std::size_t lane = 0; lane < lanes; ++lane) {
      const std::size_t i = problem.free[first + lane];
      duals[i] = Dual::variable(plain[i], lane);
    }
    const auto outputs = test_support::outputs_of<Dual>(problem.composition, duals, problem.motion);
    for (Eigen::Index row = 0; row < J.rows(); ++row)
      for (std::size_t lane = 0; lane < lanes; ++lane)
        J(row, static_cast<Eigen::Index>(first + lane)) =
            outputs[static_cast<std::size_t>(row)].derivative[lane];
  }
  return J;
}

// An output that does not depend on the free parameters gets no noise and no weight.
void choose_weights(Problem& problem, double noise) {
  const VectorXd y = predict(problem, problem.truth);
  const MatrixXd J = jacobian(problem, problem.truth);
  problem.weight = VectorXd::Zero(test_support::kOutputs);
  for (int output = 0; output < test_support::kOutputs; ++output) {
    const auto rows = Eigen::seqN(output, problem.motion.steps, test_support::kOutputs);
    const double deviation = std::sqrt((y(rows).array() - y(rows).mean()).square().mean());
    if (J(rows, Eigen::all).norm() > 0 && deviation > 0)
      problem.weight[output] = 1 / (noise * deviation);
  }
}

VectorXd clamped(const Problem& problem, VectorXd values) {
  for (Eigen::Index j = 0; j < values.size(); ++j) {
    const Parameter& parameter = problem.table[static_cast<std::size_t>(j)];
    values[j] = std::clamp(values[j], parameter.low, parameter.high);
  }
  return values;
}

struct Fit {
  VectorXd values, deviation;
};

// Levenberg–Marquardt in parameters scaled by their own sensitivity.
Fit fit(const Problem& problem, const VectorXd& measured, VectorXd values) {
  const VectorXd w = problem.weight.replicate(problem.motion.steps, 1);
  const auto cost = [&](const VectorXd& at) {
    return (w.array() * (measured - predict(problem, at)).array()).square().sum();
  };
  double damping = 1e-3, now = cost(values);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const MatrixXd J = w.asDiagonal() * jacobian(problem, values);
    const VectorXd r = w.asDiagonal() * (measured - predict(problem, values));
    const MatrixXd H = J.transpose() * J;
    const VectorXd g = J.transpose() * r;
    const VectorXd scale = H.diagonal().cwiseMax(1e-300);
    double gain = 0, step_in_deviations = 0;
    for (int attempt = 0; attempt < 12; ++attempt) {
      const MatrixXd damped = H + damping * MatrixXd{scale.asDiagonal()};
      const VectorXd next = clamped(problem, values + maths::solve_symmetric(damped, g));
      const double then = cost(next);
      if (then <= now) {
        gain = now - then;
        step_in_deviations = ((next - values).array() * scale.array().sqrt()).abs().maxCoeff();
        values = next;
        now = then;
        damping = std::max(damping / 10, 1e-12);
        break;
      }
      damping *= 10;
    }
    // Converged: the step is below a hundredth of a standard deviation.
    if (gain <= 1e-6 * now && step_in_deviations < 1e-2) break;
  }
  const MatrixXd J = w.asDiagonal() * jacobian(problem, values);
  return {values, maths::inverse(J.transpose() * J).diagonal().cwiseSqrt()};
}

VectorXd noisy(const Problem& problem, VectorXd y, std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::normal_distribution<double> normal;
  for (Eigen::Index i = 0; i < y.size(); ++i) {
    const double weight = problem.weight[i % test_support::kOutputs];
    const double draw = normal(random);
    if (weight > 0) y[i] += draw / weight;
  }
  return y;
}

class EveryKind : public testing::TestWithParam<TermKind> {};

TEST_P(EveryKind, IsRecoveredFromNoisyData) {
  const auto c = test_support::case_of(GetParam());
  Problem problem = problem_of(c);
  ASSERT_FALSE(problem.free.empty());
  const auto [seeds, enough] = trials();
  choose_weights(problem, c.noise);
  const VectorXd exact = predict(problem, problem.truth);
  std::vector<int> inside(problem.free.size());
  VectorXd mean_deviation = VectorXd::Zero(problem.truth.size());
  for (int seed = 1; seed <= seeds; ++seed) {
    std::mt19937_64 random{static_cast<std::uint64_t>(seed) + 1000};
    std::uniform_real_distribution<double> off{-c.start, c.start};
    VectorXd start = problem.truth;
    for (Eigen::Index j = 0; j < start.size(); ++j) start[j] *= 1 + off(random);
    const VectorXd measured = noisy(problem, exact, static_cast<std::uint64_t>(seed));
    const Fit found = fit(problem, measured, clamped(problem, start));
    mean_deviation += found.deviation / seeds;
    for (std::size_t j = 0; j < inside.size(); ++j) {
      const auto k = static_cast<Eigen::Index>(j);
      const double miss = std::abs(found.values[k] - problem.truth[k]);
      inside[j] += miss <= kNormalQuantile * found.deviation[k] ? 1 : 0;
    }
  }
  for (std::size_t j = 0; j < inside.size(); ++j) {
    const auto k = static_cast<Eigen::Index>(j);
    std::printf(
        "  %-24.*s %12.5g  ± %8.2g %%   %d of %d\n", static_cast<int>(problem.table[j].name.size()),
        problem.table[j].name.data(), problem.truth[k],
        100 * kNormalQuantile * mean_deviation[k] / std::abs(problem.truth[k]), inside[j], seeds);
    EXPECT_GE(inside[j], enough) << problem.table[j].name;
    // An interval wide enough to cover everything proves nothing.
    EXPECT_LT(kNormalQuantile * mean_deviation[k], 0.5 * std::abs(problem.truth[k]))
        << problem.table[j].name;
  }
}

INSTANTIATE_TEST_SUITE_P(Catalogue, EveryKind,
                         testing::ValuesIn(catalogue().begin(), catalogue().end()),
                         [](const auto& instance) { return std::string{instance.param.name}; });

}  // namespace
}  // namespace rths::sim
