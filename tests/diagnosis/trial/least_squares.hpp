// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "parameters.hpp"
#include "spectrum.hpp"

namespace trial {

double dot(const Signal& one, const Signal& other);

Signal difference(const Signal& one, const Signal& other);

/// What a set of signals spans.
class Subspace {
 public:
  /// Nothing happens if it lies in what is spanned already, or is zero.
  void add(const Signal& signal);

  /// @returns the part of a signal that no member of the set makes
  [[nodiscard]] Signal outside(const Signal& signal) const;

 private:
  std::vector<Signal> basis_;  // orthonormal
};

struct Fit {
  Physics physics{};
  double cost = 0;  ///< sum of squares
};

/// Levenberg and Marquardt's method with difference quotients, within the parameters' bounds.
Fit fit(const std::function<Signal(const Physics&)>& residual,
        const std::vector<Parameter>& parameters, const Physics& start, int iterations);

}  // namespace trial
