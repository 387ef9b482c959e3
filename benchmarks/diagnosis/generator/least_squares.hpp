// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "parameters.hpp"
#include "spectrum.hpp"

namespace trial {

double dot(const Signal& one, const Signal& other);

Signal difference(const Signal& one, const Signal& other);

/// The subspace that a set of signals spans.
class Subspace {
 public:
  /// Adds a signal; has no effect if the signal is zero or lies in the subspace.
  void add(const Signal& signal);

  /// @returns the component of a signal orthogonal to the subspace
  [[nodiscard]] Signal outside(const Signal& signal) const;

 private:
  std::vector<Signal> basis_;  // orthonormal
};

struct Fit {
  Physics physics{};
  double cost = 0;  ///< sum of squares
};

/// Levenberg–Marquardt with difference quotients, within the parameters' bounds.
Fit fit(const std::function<Signal(const Physics&)>& residual,
        const std::vector<Parameter>& parameters, const Physics& start, int iterations);

}  // namespace trial
