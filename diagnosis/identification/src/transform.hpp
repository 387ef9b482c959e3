// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <unsupported/Eigen/FFT>

namespace rths::diagnosis {

/// The next length with no prime factors but 2, 3 and 5: other transforms are slow.
inline Eigen::Index fast_length(Eigen::Index length) {
  for (;; ++length) {
    Eigen::Index rest = length;
    for (const Eigen::Index factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return length;
  }
}

/// The transform of this thread; it caches its tables by length.
inline Eigen::FFT<double>& transformer() {
  static thread_local Eigen::FFT<double> kept;
  return kept;
}

}  // namespace rths::diagnosis
