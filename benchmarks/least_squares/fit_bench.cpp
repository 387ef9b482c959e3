// SPDX-License-Identifier: Apache-2.0
//
// The project's bounded least squares beside Ceres: the same residuals, starts, bounds and scales.
//
//     rths_fit_bench CASE… [--run FOLDER]
//
// CASE: a folder with a case.toml, or the recording of a run; FOLDER: of a run
//
// Fits the model of each case as stated and extended by some of its candidates, and the transfer
// system of each axis of a run. Prints JSON.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <ceres/ceres.h>
#include <nlohmann/json.hpp>

#include <rths/cases/case.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/identification/problem.hpp>
#include <rths/models/dynamic_relation.hpp>
#include <rths/models/relations.hpp>
#include <rths/session/hybrid_test.hpp>

#include "fit_transfer.hpp"

namespace rths::benchmarks {
namespace {

using diagnosis::Fit;
using diagnosis::FitProblem;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using Json = nlohmann::json;
using Seconds = std::chrono::duration<double>;

constexpr int kMostIterations = 100;
constexpr double kTolerance = 1e-5;            // on the relative change of the cost, of both
constexpr std::size_t kCandidates = 4;         // of each case
constexpr double kSame = 1e-4, kWorse = 1e-2;  // relative difference of costs

/// Calls of the residuals.
struct Calls {
  int residuals = 0, jacobians = 0;
};

FitProblem counted(const FitProblem& problem, Calls& calls) {
  FitProblem result = problem;
  result.most_iterations = kMostIterations;
  result.tolerance = kTolerance;
  result.residuals = [&problem, &calls](const VectorXd& parameters, VectorXd& residual,
                                        MatrixXd* jacobian) {
    ++(jacobian != nullptr ? calls.jacobians : calls.residuals);
    return problem.residuals(parameters, residual, jacobian);
  };
  return result;
}

/// The residuals of a problem for Ceres, in parameters divided by their scales.
class Cost final : public ceres::CostFunction {
 public:
  explicit Cost(const FitProblem& problem) : problem_{problem} {
    set_num_residuals(static_cast<int>(problem.rows));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(problem.start.size()));
  }
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const VectorXd x = Eigen::Map<const VectorXd>(parameters[0], problem_.start.size())
                           .cwiseProduct(problem_.scale)
                           .cwiseMax(problem_.low)
                           .cwiseMin(problem_.high);
    VectorXd residual;
    MatrixXd jacobian;
    const bool wants = jacobians != nullptr && jacobians[0] != nullptr;
    if (!problem_.residuals(x, residual, wants ? &jacobian : nullptr)) return false;
    Eigen::Map<VectorXd>{residuals, problem_.rows} = residual;
    if (wants)
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>{
          jacobians[0], problem_.rows, problem_.start.size()} =
          jacobian * problem_.scale.asDiagonal();
    return true;
  }

 private:
  const FitProblem& problem_;
};

Json result_of(double cost, bool converged, const Calls& calls, Seconds time) {
  return {{"cost", cost},
          {"converged", converged},
          {"residuals", calls.residuals},
          {"jacobians", calls.jacobians},
          {"ms", 1e3 * time.count()}};
}

Json solved_here(const FitProblem& problem) {
  Calls calls;
  const auto begun = std::chrono::steady_clock::now();
  const Fit fit = diagnosis::least_squares(counted(problem, calls));
  const Seconds time = std::chrono::steady_clock::now() - begun;
  return result_of(fit.sum_of_squares / 2, fit.converged, calls, time);
}

Json solved_by_ceres(const FitProblem& given) {
  Calls calls;
  const FitProblem problem = counted(given, calls);
  const auto begun = std::chrono::steady_clock::now();
  VectorXd x = problem.start.cwiseQuotient(problem.scale);
  ceres::Problem least;
  least.AddResidualBlock(new Cost{problem}, nullptr, x.data());  // NOLINT: Ceres takes ownership
  for (Index i = 0; i < x.size(); ++i) {
    if (std::isfinite(problem.low[i]))
      least.SetParameterLowerBound(x.data(), static_cast<int>(i),
                                   problem.low[i] / problem.scale[i]);
    if (std::isfinite(problem.high[i]))
      least.SetParameterUpperBound(x.data(), static_cast<int>(i),
                                   problem.high[i] / problem.scale[i]);
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = problem.most_iterations;
  options.function_tolerance = problem.tolerance;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &least, &summary);
  const Seconds time = std::chrono::steady_clock::now() - begun;
  return result_of(summary.final_cost, summary.termination_type == ceres::CONVERGENCE, calls, time);
}

Json compared(const std::string& name, const FitProblem& problem) {
  Json found{{"name", name},
             {"parameters", problem.start.size()},
             {"rows", problem.rows},
             {"here", solved_here(problem)},
             {"ceres", solved_by_ceres(problem)}};
  const double here = found["here"]["cost"], ceres = found["ceres"]["cost"];
  found["ceres_over_here"] = ceres / here;
  std::fprintf(stderr, "%-60s %8.4g %8.4g\n", name.c_str(), here, ceres);
  return found;
}

FitProblem problem_of(const diagnosis::TestedHypothesis& tested, const diagnosis::Fold& fold) {
  const auto& hypothesis = tested.hypothesis();
  const auto count = static_cast<Index>(hypothesis.free.size());
  FitProblem problem;
  problem.start = hypothesis.values;
  problem.low = problem.high = problem.scale = VectorXd(count);
  std::vector<Index> all;
  for (Index i = 0; i < count; ++i) {
    const auto& free = hypothesis.free[static_cast<std::size_t>(i)];
    problem.low[i] = free.low;
    problem.high[i] = free.high;
    problem.scale[i] = free.scale;
    all.push_back(i);
  }
  for (const auto& share : fold.shares)
    problem.rows += tested.problem().drive(share.record).measured.size();
  problem.residuals = [&tested, fold, all](const VectorXd& values, VectorXd& residual,
                                           MatrixXd* jacobian) {
    MatrixXd none;
    return tested.evaluate(fold, values, jacobian != nullptr ? all : std::vector<Index>{}, residual,
                           jacobian != nullptr ? *jacobian : none);
  };
  return problem;
}

// The hypothesis of the base, and those with candidates at equal distances in their list.
std::vector<std::pair<std::string, diagnosis::Hypothesis>> hypotheses_of(
    const diagnosis::Relation& relation) {
  const auto& base = relation.base();
  std::vector<std::pair<std::string, diagnosis::Hypothesis>> found;
  if (!base.free.empty()) found.emplace_back("as stated", base);
  auto candidates = relation.candidates(base);
  std::erase_if(candidates, [&](const auto& one) {
    return one.frees.empty() || !diagnosis::may_extend(base, one);
  });
  const std::size_t step = std::max<std::size_t>(1, candidates.size() / kCandidates);
  for (std::size_t i = step / 2; i < candidates.size(); i += step)
    found.emplace_back(candidates[i].name,
                       diagnosis::extended(base, candidates[i], candidates[i].starts[0]));
  return found;
}

void add_case(const std::filesystem::path& folder, Json& results) {
  const diagnosis::Case c = diagnosis::load_case(folder);
  auto relation = diagnosis::is_composition(c.model.kind) ? diagnosis::force_relation(c, {})
                                                          : diagnosis::dynamic_relation(c);
  if (!relation) relation = diagnosis::actuator_relation(c, {});
  if (!relation) return;
  std::vector<const diagnosis::Record*> all, first;
  for (const auto& record : c.records) all.push_back(&record);
  first = {diagnosis::moving_records(c).front()};
  const diagnosis::SensorNoise noise{all, c.noise};
  diagnosis::Problem problem{*relation, first, noise, 1};
  for (const auto& [name, hypothesis] : hypotheses_of(*relation)) {
    const std::string title = c.name + ": " + name;
    try {
      problem.renew_noise(hypothesis);
      const diagnosis::TestedHypothesis tested{problem, hypothesis};
      results.push_back(compared(title, problem_of(tested, diagnosis::whole({0}))));
    } catch (const Error& error) {
      std::fprintf(stderr, "%s: %s\n", title.c_str(), error.what());
    }
  }
}

void add_run(const std::filesystem::path& folder, Json& results) {
  const recording::Reader run{folder / "run.h5"};
  for (const std::string& axis : names_of(kHorizontal)) {
    const auto record = session::transfer_record_of(recording::roles_of(run), run, axis, {});
    results.push_back(compared(std::string{"transfer system: "} + axis, transfer_problem(record)));
  }
}

Json summary_of(const Json& fits) {
  int same = 0, here_lower = 0, ceres_lower = 0, ceres_lower_by_1_percent = 0,
      here_lower_by_1_percent = 0;
  double here_ms = 0, ceres_ms = 0, here_calls = 0, ceres_calls = 0;
  const auto calls = [](const Json& one) {
    return one["residuals"].get<double>() + one["jacobians"].get<double>();
  };
  for (const auto& fit : fits) {
    const double ratio = fit["ceres_over_here"];
    same += std::abs(ratio - 1) <= kSame ? 1 : 0;
    here_lower += ratio > 1 + kSame ? 1 : 0;
    ceres_lower += ratio < 1 - kSame ? 1 : 0;
    here_lower_by_1_percent += ratio > 1 + kWorse ? 1 : 0;
    ceres_lower_by_1_percent += ratio < 1 - kWorse ? 1 : 0;
    here_ms += fit["here"]["ms"].get<double>();
    ceres_ms += fit["ceres"]["ms"].get<double>();
    here_calls += calls(fit["here"]);
    ceres_calls += calls(fit["ceres"]);
  }
  return {{"fits", fits.size()},
          {"same_cost", same},
          {"here_lower", here_lower},
          {"ceres_lower", ceres_lower},
          {"here_lower_by_1_percent", here_lower_by_1_percent},
          {"ceres_lower_by_1_percent", ceres_lower_by_1_percent},
          {"here_s", here_ms / 1e3},
          {"ceres_s", ceres_ms / 1e3},
          {"ceres_over_here_time", ceres_ms / here_ms},
          {"here_calls", here_calls},
          {"ceres_calls", ceres_calls}};
}

int run(const std::vector<std::string>& arguments) {
  Json fits = Json::array();
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i] == "--run" && i + 1 < arguments.size())
      add_run(arguments[++i], fits);
    else
      add_case(arguments[i], fits);
  }
  std::printf("%s\n", Json{{"all", summary_of(fits)}, {"each", fits}}.dump(2).c_str());
  return 0;
}

}  // namespace
}  // namespace rths::benchmarks

int main(int argc, char** argv) {
  try {
    return rths::benchmarks::run({argv + 1, argv + argc});
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
