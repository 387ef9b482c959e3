// SPDX-License-Identifier: Apache-2.0
#include "identification.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::adapters {
namespace {

using Eigen::Index;
using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

// Slow enough for any machine, far enough apart to separate mass from stiffness.
constexpr double kFrequency[] = {1.0, 3.0};   // [Hz]
constexpr double kRamp = 0.5, kFitted = 3.0;  // [s]
constexpr double kLongestStep = 0.034;        // ten per shortest period [s]
constexpr double kLeastMove = 0.1;            // of the amplitude

// Fit of a measurement: offset, drift, and cosine and sine at each frequency.
constexpr Index kRegressors = 6;
Eigen::Matrix<double, kRegressors, 1> regressors(double time) {
  const double a = 2 * pi * kFrequency[0] * time, b = 2 * pi * kFrequency[1] * time;
  return {1, time, std::cos(a), std::sin(a), std::cos(b), std::sin(b)};
}

// Z of A Z = B, as real equations of twice the size: a complex decomposition takes 10 s to compile.
MatrixXcd solve(const MatrixXcd& a, const MatrixXcd& b) {
  const Index n = a.rows();
  MatrixXd left(2 * n, 2 * n), right(2 * n, b.cols());
  left.topLeftCorner(n, n) = left.bottomRightCorner(n, n) = a.real();
  left.bottomLeftCorner(n, n) = a.imag();
  left.topRightCorner(n, n) = -a.imag();
  right.topRows(n) = b.real();
  right.bottomRows(n) = b.imag();
  const MatrixXd found = maths::solve_least_squares(left, right);
  MatrixXcd z(n, b.cols());
  z.real() = found.topRows(n);
  z.imag() = found.bottomRows(n);
  return z;
}

// The sum of both frequencies stays within the amplitude.
double excitation(double time) {
  double sum = 0;
  for (const double frequency : kFrequency) sum += 0.5 * std::sin(2 * pi * frequency * time);
  const double from_end = std::min(time, 2 * kRamp + kFitted - time);
  if (from_end >= kRamp) return sum;
  return from_end <= 0 ? 0 : 0.5 * (1 - std::cos(pi * from_end / kRamp)) * sum;
}

// Damping and mass must be positive semidefinite: negative eigenvalues, caused by noise, become 0.
MatrixXd passive(const MatrixXd& matrix) {
  const maths::Modes modes = maths::symmetric_modes((matrix + matrix.transpose()) / 2);
  return modes.vectors * modes.values.cwiseMax(0).asDiagonal() * modes.vectors.transpose();
}

}  // namespace

SpecimenIdentification::SpecimenIdentification(Index components, const VectorXd& amplitude,
                                               double step)
    : components_{components},
      amplitude_{amplitude},
      step_{step},
      steps_{static_cast<int>(std::lround((2 * kRamp + kFitted) / step))} {
  if (step > kLongestStep)
    throw Error{
        fmt::format("identification: the target interval is {:g} s, expected at most {:g} s to "
                    "resolve {:g} Hz; or state the matrices instead of \"identified\"",
                    step, kLongestStep, kFrequency[1])};
  for (std::size_t i = 0; i < kFrequencies; ++i)
    displacement_[i] = force_[i] = MatrixXcd::Zero(components, components);
  start_component();
}

void SpecimenIdentification::start_component() {
  taken_ = 0;
  normal_ = MatrixXd::Zero(kRegressors, kRegressors);
  observed_ = MatrixXd::Zero(kRegressors, 2 * components_);
}

bool SpecimenIdentification::is_done() const { return at_ == components_; }

double SpecimenIdentification::time() const { return (taken_ + 1) * step_; }

VectorXd SpecimenIdentification::target() const {
  VectorXd target = VectorXd::Zero(components_);
  target[at_] = amplitude_[at_] * excitation(time());
  return target;
}

void SpecimenIdentification::measure(const VectorXd& displacement, const VectorXd& force) {
  if (time() >= kRamp && time() <= kRamp + kFitted) {
    const auto row = regressors(time());
    VectorXd measured{2 * components_};
    measured << displacement, force;
    normal_ += row * row.transpose();
    observed_ += row * measured.transpose();
  }
  if (++taken_ < steps_) return;
  finish_component();
  ++at_;
  start_component();
}

// cos and sin parts c, s of a signal c·cos ωt + s·sin ωt are the complex amplitude c − i·s.
void SpecimenIdentification::finish_component() {
  const MatrixXd fit = maths::solve_symmetric(normal_, observed_);
  for (std::size_t i = 0; i < kFrequencies; ++i) {
    const auto cosine = fit.row(2 + 2 * static_cast<Index>(i)).transpose();
    const auto sine = fit.row(3 + 2 * static_cast<Index>(i)).transpose();
    const Eigen::VectorXcd amplitude =
        cosine.cast<std::complex<double>>() - std::complex<double>{0, 1} * sine;
    displacement_[i].col(at_) = amplitude.head(components_);
    force_[i].col(at_) = amplitude.tail(components_);
  }
}

std::array<MatrixXcd, 2> SpecimenIdentification::dynamic_stiffness() const {
  std::array<MatrixXcd, kFrequencies> stiffness;
  for (std::size_t i = 0; i < kFrequencies; ++i) {
    for (Index k = 0; k < components_; ++k) {
      const double moved =
          2 * std::abs(displacement_[i](
                  k, k));  // the excitation has half the amplitude at each frequency
      if (!(moved > kLeastMove * amplitude_[k]))
        throw Error{fmt::format(
            "identification: component {} moved {:.3g} at {:g} Hz, expected about {:.3g}: is the "
            "machine on?",
            k + 1, moved, kFrequency[i], amplitude_[k])};
    }
    stiffness[i] = solve(displacement_[i].transpose(), force_[i].transpose()).transpose();
  }
  return stiffness;
}

SpecimenIdentification::Properties SpecimenIdentification::properties() const {
  const auto [slow, fast] = dynamic_stiffness();
  const double a = 2 * pi * kFrequency[0], b = 2 * pi * kFrequency[1];
  Properties properties;
  properties.mass = (slow.real() - fast.real()) / (b * b - a * a);
  properties.stiffness = slow.real() + a * a * properties.mass;
  properties.damping = (a * slow.imag() + b * fast.imag()) / (a * a + b * b);
  properties.stiffness = (properties.stiffness + properties.stiffness.transpose().eval()) / 2;
  properties.damping = passive(properties.damping);
  properties.mass = passive(properties.mass);
  if (!(properties.stiffness.diagonal().minCoeff() > 0))
    throw Error{fmt::format("identification: found a stiffness of {:.4g}, expected more than 0",
                            properties.stiffness.diagonal().minCoeff())};
  return properties;
}

}  // namespace rths::adapters
