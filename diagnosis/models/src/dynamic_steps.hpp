// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include <rths/identification/vectors.hpp>
#include <rths/sim/dual.hpp>

#include "dynamic_model.hpp"

namespace rths::diagnosis {

/// A small dense matrix whose entries may carry derivatives.
template <class Real>
struct SmallMatrix {
  struct Position {
    Index row, column;
  };
  Index rows = 0, columns = 0;
  std::vector<Real> entries;     ///< row by row
  std::vector<Position> filled;  ///< of entries with a non-zero value or derivative

  SmallMatrix() = default;
  explicit SmallMatrix(const MatrixXd& values);
  /// Call after the entries have been changed.
  void find_filled();
  [[nodiscard]] Real& operator()(Index row, Index column) {
    return entries[static_cast<std::size_t>(row * columns + column)];
  }
  [[nodiscard]] const Real& operator()(Index row, Index column) const {
    return entries[static_cast<std::size_t>(row * columns + column)];
  }
};

/// sum += a x
inline void add_product(double& sum, double a, double x) { sum += a * x; }
inline void add_product(sim::Dual& sum, double a, const sim::Dual& x) {
  sum.value += a * x.value;
  for (std::size_t i = 0; i < sim::Dual::kLanes; ++i) sum.derivative[i] += a * x.derivative[i];
}
inline void add_product(sim::Dual& sum, const sim::Dual& a, const sim::Dual& x) {
  sum.value += a.value * x.value;
  for (std::size_t i = 0; i < sim::Dual::kLanes; ++i)
    sum.derivative[i] += a.value * x.derivative[i] + a.derivative[i] * x.value;
}

/// y += A x
template <class Entry, class Real>
void add_product(const SmallMatrix<Entry>& a, const Real* x, Real* y) {
  for (const auto& [row, column] : a.filled) add_product(y[row], a(row, column), x[column]);
}

/// A linear system over one step. Exact for inputs that vary linearly from its start (0) to its end
/// (1), and for forces on a parabola through the previous step (−), the start and the end:
///     x₁ = Φ x₀ + B₀ u₀ + B₁ u₁ + E₋ f₋ + E₀ f₀ + E₁ f₁
template <class Entry>
struct StepMatrices {
  SmallMatrix<Entry> phi, b0, b1, e_before, e0, e1;
  SmallMatrix<Entry> c, d, h, p, q, r, s, t;  ///< as of LinearSystem
  SmallMatrix<Entry> stiffness, damping;      ///< of the connections, columns
  SmallMatrix<Entry> yield, yield_rate;  ///< ∂d₁/∂f₁ = P E₁, ∂d'₁/∂f₁ = R E₁
};

/// @param length  of a step [s]; for a sampled system, its time step
[[nodiscard]] StepMatrices<double> step_matrices(const LinearSystem& system, double length,
                                                 bool sampled);

/// Step matrices slightly above and below a parameter's value, for the derivative in one lane.
struct LaneMatrices {
  std::size_t lane;
  StepMatrices<double> above, below;
  double distance;  ///< of the two values
};
/// Adds derivatives by central differences. Lanes that are not listed have none.
[[nodiscard]] StepMatrices<sim::Dual> with_lanes(const StepMatrices<double>& steps,
                                                 const std::vector<LaneMatrices>& lanes);

/// Interpolation of a signal between samples: weights of the samples around, by substep.
struct Interpolation {
  Index before = 0;  ///< offset of the first weight before the current sample [samples]
  std::vector<std::vector<double>> start, end;  ///< weights at the ends of each substep
};
[[nodiscard]] Interpolation interpolation(Hold hold, int substeps);

/// The signal at the start or the end of a substep. Beyond its ends it is constant.
template <class Real>
[[nodiscard]] Real between(const std::vector<Real>& signal, Index sample, Index before,
                           const std::vector<double>& weights) {
  const auto last = static_cast<Index>(signal.size()) - 1;
  Real sum{};
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Index at = sample - before + static_cast<Index>(i);
    add_product(sum, weights[i],
                signal[static_cast<std::size_t>(std::min(std::max<Index>(at, 0), last))]);
  }
  return sum;
}

}  // namespace rths::diagnosis
