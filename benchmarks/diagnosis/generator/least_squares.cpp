// SPDX-License-Identifier: Apache-2.0
#include "least_squares.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace trial {
namespace {

using Matrix = std::vector<std::vector<double>>;

// Gaussian elimination with pivots. A singular column gives a step of zero.
std::vector<double> solved(Matrix A, std::vector<double> b) {
  const std::size_t n = b.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k; i < n; ++i)
      if (std::abs(A[i][k]) > std::abs(A[pivot][k])) pivot = i;
    std::swap(A[k], A[pivot]);
    std::swap(b[k], b[pivot]);
    if (A[k][k] == 0) continue;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = A[i][k] / A[k][k];
      for (std::size_t j = k; j < n; ++j) A[i][j] -= factor * A[k][j];
      b[i] -= factor * b[k];
    }
  }
  std::vector<double> x(n, 0);
  for (std::size_t k = n; k-- > 0;) {
    double sum = b[k];
    for (std::size_t j = k + 1; j < n; ++j) sum -= A[k][j] * x[j];
    x[k] = A[k][k] == 0 ? 0 : sum / A[k][k];
  }
  return x;
}

std::vector<Signal> quotients(const std::function<Signal(const Physics&)>& residual,
                              const std::vector<Parameter>& parameters, const Physics& at,
                              const Signal& here) {
  std::vector<Signal> columns;
  for (const Parameter parameter : parameters) {
    constexpr double kFraction = 0.1;  // of the significant step
    double step = kFraction * info(parameter).step;
    if (at[parameter] + step > info(parameter).high) step = -step;
    Physics beside = at;
    beside[parameter] += step;
    Signal column = difference(residual(beside), here);
    for (double& value : column) value /= kFraction * (step < 0 ? -1 : 1);
    columns.push_back(std::move(column));
  }
  return columns;
}

Physics moved(const Physics& from, const std::vector<Parameter>& parameters,
              const std::vector<double>& by) {
  Physics to = from;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterInfo& bounds = info(parameters[i]);
    to[parameters[i]] =
        std::clamp(from[parameters[i]] - by[i] * bounds.step, bounds.low, bounds.high);
  }
  return to;
}

// The normal equations, A x = b.
struct Normal {
  Matrix A;
  std::vector<double> b;
};

Normal normal_of(const std::vector<Signal>& J, const Signal& residual) {
  const std::size_t n = J.size();
  Normal normal{Matrix(n, std::vector<double>(n)), std::vector<double>(n)};
  for (std::size_t r = 0; r < n; ++r) {
    normal.b[r] = dot(J[r], residual);
    for (std::size_t c = 0; c < n; ++c) normal.A[r][c] = c < r ? normal.A[c][r] : dot(J[r], J[c]);
  }
  return normal;
}

std::vector<double> step_of(const Normal& normal, double damping) {
  Matrix damped = normal.A;
  for (std::size_t k = 0; k < damped.size(); ++k) damped[k][k] *= 1 + damping;
  return solved(std::move(damped), normal.b);
}

constexpr int kTries = 5;
constexpr double kRelax = 5, kTighten = 8;  // of the damping after success, failure

}  // namespace

double dot(const Signal& one, const Signal& other) {
  double sum = 0;
  for (std::size_t k = 0; k < one.size(); ++k) sum += one[k] * other[k];
  return sum;
}

Signal difference(const Signal& one, const Signal& other) {
  Signal result = one;
  for (std::size_t k = 0; k < result.size(); ++k) result[k] -= other[k];
  return result;
}

Signal Subspace::outside(const Signal& signal) const {
  Signal rest = signal;
  for (int pass = 0; pass < 2; ++pass)  // twice is enough against round-off
    for (const Signal& direction : basis_) {
      const double share = dot(direction, rest);
      for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= share * direction[k];
    }
  return rest;
}

void Subspace::add(const Signal& signal) {
  constexpr double kCut = 1e-6;
  Signal rest = outside(signal);
  const double length = std::sqrt(dot(rest, rest));
  if (length <= kCut * std::sqrt(dot(signal, signal))) return;
  for (double& value : rest) value /= length;
  basis_.push_back(std::move(rest));
}

Fit fit(const std::function<Signal(const Physics&)>& residual,
        const std::vector<Parameter>& parameters, const Physics& start, int iterations) {
  constexpr double kDone = 1e-5;
  Fit best{.physics = start};
  Signal here = residual(start);
  best.cost = dot(here, here);
  double damping = 1e-3;
  for (int i = 0; i < iterations; ++i) {
    const Normal normal = normal_of(quotients(residual, parameters, best.physics, here), here);
    const double before = best.cost;
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const Physics there = moved(best.physics, parameters, step_of(normal, damping));
      Signal residual_there = residual(there);
      const double cost = dot(residual_there, residual_there);
      damping *= cost < best.cost ? 1.0 / kRelax : kTighten;
      if (cost >= best.cost) continue;
      best = {there, cost};
      here = std::move(residual_there);
      break;
    }
    if (before - best.cost <= kDone * before) break;
  }
  return best;
}

}  // namespace trial
