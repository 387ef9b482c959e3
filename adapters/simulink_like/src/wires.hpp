// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

namespace rths::adapters {

/// Pointers to a block's values: inputs, outputs and parameters in the order of its type's
/// declaration. A per-axis port points to the first of `axes` values.
struct Wires {
  std::vector<const double*> in;
  std::vector<double*> out;
  std::vector<const double*> parameter;
  std::size_t axes = 0;
  double time = 0;         ///< of the step [s]
  bool is_missed = false;  ///< the step is made after its time
};

/// Index of the input, output or parameter of a block that has one.
inline constexpr std::size_t kOnly = 0;

}  // namespace rths::adapters
