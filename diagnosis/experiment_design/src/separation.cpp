// SPDX-License-Identifier: Apache-2.0
#include "separation.hpp"

#include <algorithm>
#include <numeric>

#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

constexpr double kFarthest = 100;  // largest change of a parameter by a refit [scales]

// Fits parameters to a difference of predictions, by normal equations.
struct Normal {
  MatrixXd curvature;
  VectorXd slope;
  double square = 0;

  void add(const MatrixXd& jacobian, const VectorXd& difference) {
    if (curvature.size() == 0) {
      curvature = MatrixXd::Identity(jacobian.cols(), jacobian.cols()) / (kFarthest * kFarthest);
      slope = VectorXd::Zero(jacobian.cols());
    }
    curvature += jacobian.transpose() * jacobian;
    slope += jacobian.transpose() * difference;
    square += difference.squaredNorm();
  }
  [[nodiscard]] double remainder() const {  // of the difference, after the fit [nat]
    const double fitted =
        slope.size() > 0 ? slope.dot(maths::solve_symmetric(curvature, slope)) : 0;
    return std::max(0.0, (square - fitted) / 2);
  }
};

std::vector<Index> all(const Hypothesis& hypothesis) {
  std::vector<Index> indices(hypothesis.free.size());
  std::iota(indices.begin(), indices.end(), Index{0});
  return indices;
}
VectorXd scales(const Hypothesis& hypothesis) {
  VectorXd scale(hypothesis.values.size());
  for (Index i = 0; i < scale.size(); ++i)
    scale[i] = hypothesis.free[static_cast<std::size_t>(i)].scale;
  return scale;
}

// One Gauss-Newton step on both folds, because a rival was fitted to one fold only.
Hypothesis settled(const RelationFindings& found, Hypothesis hypothesis, PredictedRows& rows) {
  const Fold& both = found.folds.both;
  TestedHypothesis tested{*found.problem, std::move(hypothesis)};
  Hypothesis result = tested.hypothesis();
  if (!tested.evaluate(both, result.values, all(result), rows.residual, rows.jacobian))
    return result;
  const VectorXd scale = scales(result);
  rows.jacobian *= scale.asDiagonal();
  MatrixXd curvature = rows.jacobian.transpose() * rows.jacobian;
  curvature.diagonal().array() += 1 / (kFarthest * kFarthest);
  VectorXd values =
      result.values - scale.cwiseProduct(maths::solve_symmetric(
                          curvature, VectorXd{rows.jacobian.transpose() * rows.residual}));
  for (Index i = 0; i < values.size(); ++i) {
    const auto& free = result.free[static_cast<std::size_t>(i)];
    values[i] = std::clamp(values[i], free.low, free.high);
  }
  VectorXd residual;
  MatrixXd none;
  if (tested.evaluate(both, values, {}, residual, none) &&
      residual.squaredNorm() < rows.residual.squaredNorm()) {
    rows.residual = residual;
    result.values = values;
  }
  return result;
}

// The hypothesis without the terms of the specimen.
Hypothesis machine_of(const Hypothesis& hypothesis) {
  Hypothesis rest;
  for (const auto& term : hypothesis.terms)
    if (sim::term_kind(term.settings.kind).stage > sim::Stage::Restoring)
      rest.terms.push_back(term);
  std::vector<double> values;
  for (std::size_t i = 0; i < hypothesis.free.size(); ++i) {
    const std::string& name = hypothesis.free[i].name;
    const std::string term = name.substr(0, name.rfind('.'));
    if (std::none_of(rest.terms.begin(), rest.terms.end(), [&](const ModelTerm& placed) {
          return placed.settings.name == term || placed.settings.name.starts_with(term + ".");
        }))
      continue;
    rest.free.push_back(hypothesis.free[i]);
    values.push_back(hypothesis.values[static_cast<Index>(i)]);
  }
  rest.values = VectorXd::Map(values.data(), static_cast<Index>(values.size()));
  return rest;
}

// Indices of the parameters of a hypothesis among those of a larger one.
std::vector<Index> positions(const Hypothesis& subset, const Hypothesis& of) {
  std::vector<Index> found;
  for (const auto& free : subset.free)
    for (std::size_t i = 0; i < of.free.size(); ++i)
      if (of.free[i].name == free.name) found.push_back(static_cast<Index>(i));
  return found;
}

bool has_empty(const Tests& tests) {
  return std::any_of(tests.designs.begin(), tests.designs.end(),
                     [](const Design& design) { return design.is_empty; });
}

std::vector<const Record*> records_of(const std::vector<Design>& designs) {
  std::vector<const Record*> records;
  for (const auto& design : designs) records.push_back(&design.record);
  return records;
}

}  // namespace

Tests::Tests(const Problem& like, bool is_removable)
    : designs{designs_for(like, is_removable)}, problem{like, records_of(designs)} {}

Side::Side(const RelationFindings& found, const Tests& tests, Hypothesis hypothesis)
    : hypothesis_{settled(found, std::move(hypothesis), records_)},
      tests_{&tests},
      whole_{tests.problem, hypothesis_},
      empty_{tests.problem, has_empty(tests) ? machine_of(hypothesis_) : hypothesis_} {}

const TestedHypothesis& Side::on(std::size_t test) const {
  return tests_->designs[test].is_empty ? empty_ : whole_;
}

const VectorXd& Side::residual(std::size_t test) {
  const auto known = residuals_.find(test);
  if (known != residuals_.end()) return known->second;
  VectorXd& residual = residuals_[test];
  MatrixXd none;
  if (!on(test).evaluate(compared(tests_->problem, {test}), on(test).hypothesis().values, {},
                         residual, none))
    residual.resize(0);
  return residual;
}

const MatrixXd& Side::jacobian(std::size_t test) {
  const auto known = jacobians_.find(test);
  if (known != jacobians_.end()) return known->second;
  const Hypothesis& there = on(test).hypothesis();
  MatrixXd& jacobian = jacobians_[test];
  jacobian = MatrixXd::Zero(residual(test).size(), hypothesis_.values.size());
  VectorXd residual;
  MatrixXd columns;
  if (on(test).evaluate(compared(tests_->problem, {test}), there.values, all(there), residual,
                        columns))
    jacobian(Eigen::all, positions(there, hypothesis_)) = columns * scales(there).asDiagonal();
  return jacobian;
}

double distance(Side& one, Side& other, std::size_t test) {
  const VectorXd &a = one.residual(test), &b = other.residual(test);
  return a.size() > 0 && a.size() == b.size() ? (a - b).norm() : 0;
}

double expected_gain(Side& one, Side& other, std::size_t test) {
  if (!(distance(one, other, test) > 0)) return 0;
  if (one.records().residual.size() != other.records().residual.size()) return 0;
  const VectorXd before = one.records().residual - other.records().residual;
  const VectorXd after = one.residual(test) - other.residual(test);
  double sum = 0;
  for (Side* loser : {&one, &other}) {
    Normal normal;
    normal.add(loser->records().jacobian, before);
    const double known = normal.remainder();
    normal.add(loser->jacobian(test), after);
    sum += std::max(0.0, normal.remainder() - known);
  }
  return sum / 2;
}

}  // namespace rths::diagnosis
