// SPDX-License-Identifier: Apache-2.0
#include <rths/maths/fourier.hpp>

#include <cmath>
#include <numbers>

#include <unsupported/Eigen/FFT>

namespace rths::maths {
namespace {

Eigen::FFT<double>& transformer() {
  static thread_local Eigen::FFT<double> kept;
  return kept;
}

}  // namespace

Eigen::Index fast_length(Eigen::Index length) {
  for (;; ++length) {
    Eigen::Index rest = length;
    for (const Eigen::Index factor : {2, 3, 5})
      while (rest % factor == 0) rest /= factor;
    if (rest == 1) return length;
  }
}

Eigen::VectorXcd spectrum(const Eigen::VectorXd& signal) {
  Eigen::VectorXcd bins;
  transformer().fwd(bins, signal);
  return bins;
}

Eigen::VectorXcd half_spectrum(const Eigen::VectorXd& signal) {
  return spectrum(signal).head(signal.size() / 2 + 1);
}

Eigen::VectorXd signal_of(const Eigen::VectorXcd& spectrum) {
  Eigen::VectorXd signal;
  transformer().inv(signal, spectrum);
  return signal;
}

Eigen::VectorXd hann_window(Eigen::Index length, double shift) {
  Eigen::VectorXd window(length);
  for (Eigen::Index i = 0; i < length; ++i)
    window[i] = 0.5 * (1 - std::cos(2 * std::numbers::pi * (static_cast<double>(i) + shift) /
                                    static_cast<double>(length)));
  return window;
}

}  // namespace rths::maths
