// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

/// Discrete Fourier transforms of real signals. Each thread keeps the tables of the lengths that it
/// has used.   @setup
namespace rths::maths {

/// The next length with no prime factors but 2, 3 and 5: other transforms are slow.
[[nodiscard]] Eigen::Index fast_length(Eigen::Index length);

/// X_k = Σ x_n exp(−2πi kn/N), 0 ≤ k < N.
[[nodiscard]] Eigen::VectorXcd spectrum(const Eigen::VectorXd& signal);
/// The same for 0 ≤ k ≤ N/2; the others are their conjugates.
[[nodiscard]] Eigen::VectorXcd half_spectrum(const Eigen::VectorXd& signal);
/// The signal of a spectrum of all N frequencies.
[[nodiscard]] Eigen::VectorXd signal_of(const Eigen::VectorXcd& spectrum);

/// Hann window: (1 − cos(2π (n + shift)/N))/2.
/// @param shift  0: periodic, from 0 on; 0.5: symmetric   [samples]
[[nodiscard]] Eigen::VectorXd hann_window(Eigen::Index length, double shift);

}  // namespace rths::maths
