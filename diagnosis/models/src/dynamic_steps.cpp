// SPDX-License-Identifier: Apache-2.0
#include "dynamic_steps.hpp"

#include <array>
#include <cmath>
#include <numbers>

#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

// Modified Bessel function of the first kind, by its power series.
double bessel_i0(double x) {
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) {
    term *= 0.25 * x * x / (k * k);
    sum += term;
  }
  return sum;
}

// Whittaker-Shannon within a Kaiser window: 8 samples to each side, 60 dB.
constexpr int kFilterReach = 8;
constexpr double kWindowShape = 5.65;

double band_limited(double distance) {
  if (std::abs(distance) >= kFilterReach) return 0;
  const double x = std::numbers::pi * distance;
  const double sinc = std::abs(x) < 1e-12 ? 1 : std::sin(x) / x;
  const double ratio = distance / kFilterReach;
  return sinc * bessel_i0(kWindowShape * std::sqrt(1 - ratio * ratio)) / bessel_i0(kWindowShape);
}

std::vector<double> weights_at(Hold hold, double fraction) {
  if (hold == Hold::Linear) return {1 - fraction, fraction};
  std::vector<double> weights;
  double sum = 0;
  for (int i = 1 - kFilterReach; i <= kFilterReach; ++i)
    weights.push_back(band_limited(fraction - i));
  for (const double weight : weights) sum += weight;
  for (double& weight : weights) weight /= sum;  // preserves constants
  return weights;
}

MatrixXd joined(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd both(a.rows(), a.cols() + b.cols());
  both << a, b;
  return both;
}

// All matrices of a step.
constexpr auto members() {
  return std::array{&StepMatrices<double>::phi,       &StepMatrices<double>::b0,
                    &StepMatrices<double>::b1,        &StepMatrices<double>::e_before,
                    &StepMatrices<double>::e0,        &StepMatrices<double>::e1,
                    &StepMatrices<double>::c,         &StepMatrices<double>::d,
                    &StepMatrices<double>::h,         &StepMatrices<double>::p,
                    &StepMatrices<double>::q,         &StepMatrices<double>::r,
                    &StepMatrices<double>::s,         &StepMatrices<double>::t,
                    &StepMatrices<double>::stiffness, &StepMatrices<double>::damping,
                    &StepMatrices<double>::yield,     &StepMatrices<double>::yield_rate};
}
constexpr auto dual_members() {
  using Dual = sim::Dual;
  return std::array{
      &StepMatrices<Dual>::phi,      &StepMatrices<Dual>::b0,    &StepMatrices<Dual>::b1,
      &StepMatrices<Dual>::e_before, &StepMatrices<Dual>::e0,    &StepMatrices<Dual>::e1,
      &StepMatrices<Dual>::c,        &StepMatrices<Dual>::d,     &StepMatrices<Dual>::h,
      &StepMatrices<Dual>::p,        &StepMatrices<Dual>::q,     &StepMatrices<Dual>::r,
      &StepMatrices<Dual>::s,        &StepMatrices<Dual>::t,     &StepMatrices<Dual>::stiffness,
      &StepMatrices<Dual>::damping,  &StepMatrices<Dual>::yield, &StepMatrices<Dual>::yield_rate};
}

// Effect on the state of an input within a step: constant, and growing as τ or τ², 0 ≤ τ ≤ 1.
struct Moments {
  MatrixXd phi, constant, linear, square;
};

// The matrix exponential of the system with the input and its two integrals as further states.
Moments moments_of(const MatrixXd& a, const MatrixXd& drive, double length) {
  const Index n = a.rows(), w = drive.cols();
  MatrixXd whole = MatrixXd::Zero(n + 3 * w, n + 3 * w);
  whole.topLeftCorner(n, n) = a * length;
  whole.block(0, n, n, w) = drive * length;
  whole.block(n, n + w, w, w).setIdentity();
  whole.block(n + w, n + 2 * w, w, w).setIdentity();
  const MatrixXd after = maths::exponential(whole);
  return {after.topLeftCorner(n, n), after.block(0, n, n, w), after.block(0, n + w, n, w),
          2 * after.block(0, n + 2 * w, n, w)};
}

}  // namespace

template <class Real>
SmallMatrix<Real>::SmallMatrix(const MatrixXd& values)
    : rows{values.rows()}, columns{values.cols()} {
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j) entries.push_back(Real{values(i, j)});
  find_filled();
}

template <class Real>
void SmallMatrix<Real>::find_filled() {
  filled.clear();
  for (Index i = 0; i < rows; ++i)
    for (Index j = 0; j < columns; ++j)
      if (!sim::is_just((*this)(i, j), 0)) filled.push_back({i, j});
}
template struct SmallMatrix<double>;
template struct SmallMatrix<sim::Dual>;

StepMatrices<double> step_matrices(const LinearSystem& system, double length, bool sampled) {
  const Index n = system.a.rows(), inputs = system.b.cols(), forces = system.e.cols();
  const MatrixXd drive = joined(system.b, system.e);
  const MatrixXd none = MatrixXd::Zero(n, drive.cols());
  const Moments moments = sampled || n == 0 ? Moments{system.a, drive, none, none}
                                            : moments_of(system.a, drive, length);
  const MatrixXd start = moments.constant - moments.linear;
  const MatrixXd bend = 0.5 * (moments.square - moments.linear).rightCols(forces);
  const MatrixXd e1 = moments.linear.rightCols(forces) + bend;
  StepMatrices<double> steps;
  steps.phi = SmallMatrix<double>{moments.phi};
  steps.b0 = SmallMatrix<double>{start.leftCols(inputs)};
  steps.b1 = SmallMatrix<double>{moments.linear.leftCols(inputs)};
  steps.e_before = SmallMatrix<double>{bend};
  steps.e0 = SmallMatrix<double>{start.rightCols(forces) - 2 * bend};
  steps.e1 = SmallMatrix<double>{e1};
  steps.c = SmallMatrix<double>{system.c};
  steps.d = SmallMatrix<double>{system.d};
  steps.h = SmallMatrix<double>{system.h};
  steps.p = SmallMatrix<double>{system.p};
  steps.q = SmallMatrix<double>{system.q};
  steps.r = SmallMatrix<double>{system.r};
  steps.s = SmallMatrix<double>{system.s};
  steps.t = SmallMatrix<double>{system.t};
  steps.stiffness = SmallMatrix<double>{system.stiffness};
  steps.damping = SmallMatrix<double>{system.damping};
  steps.yield = SmallMatrix<double>{system.p * e1};
  steps.yield_rate = SmallMatrix<double>{system.r * e1};
  return steps;
}

StepMatrices<sim::Dual> with_lanes(const StepMatrices<double>& steps,
                                   const std::vector<LaneMatrices>& lanes) {
  StepMatrices<sim::Dual> result;
  for (std::size_t m = 0; m < members().size(); ++m) {
    const SmallMatrix<double>& values = steps.*members()[m];
    SmallMatrix<sim::Dual>& duals = result.*dual_members()[m];
    duals.rows = values.rows;
    duals.columns = values.columns;
    duals.entries.assign(values.entries.begin(), values.entries.end());
    for (const LaneMatrices& lane : lanes)
      for (std::size_t i = 0; i < values.entries.size(); ++i)
        duals.entries[i].derivative[lane.lane] =
            ((lane.above.*members()[m]).entries[i] - (lane.below.*members()[m]).entries[i]) /
            lane.distance;
    duals.find_filled();
  }
  return result;
}

Interpolation interpolation(Hold hold, int substeps) {
  Interpolation result;
  result.before = hold == Hold::Smooth ? kFilterReach - 1 : 0;
  for (int i = 0; i < substeps; ++i) {
    if (hold == Hold::Zero) {
      result.start.push_back({1});
      result.end.push_back({1});
      continue;
    }
    result.start.push_back(weights_at(hold, static_cast<double>(i) / substeps));
    result.end.push_back(weights_at(hold, static_cast<double>(i + 1) / substeps));
  }
  return result;
}

}  // namespace rths::diagnosis
