// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/target_smoothing.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr Require kRequireSmoothing{"adaptive inverse"};
constexpr double kNotchDamping = 0.4;    // of its poles
constexpr double kNotchDepth = 0.1;      // gain at its frequency
constexpr double kLongestAverage = 0.1;  // [s]

/// Power series of a filter in the backward difference D, up to D⁴. A delay of one sample is
/// 1 − h D exactly.
using Series = std::array<double, TargetSmoothing::kDerivatives>;

Series product(const Series& a, const Series& b) {
  Series c{};
  for (std::size_t i = 0; i < c.size(); ++i)
    for (std::size_t j = 0; j <= i; ++j) c[i] += a[j] * b[i - j];
  return c;
}

Series reciprocal(const Series& a) {
  Series c{1 / a[0]};
  for (std::size_t i = 1; i < c.size(); ++i) {
    for (std::size_t j = 1; j <= i; ++j) c[i] -= a[j] * c[i - j];
    c[i] /= a[0];
  }
  return c;
}

/// Of Σ weights[k] z⁻ᵏ.
template <class Weights>
Series series_of(const Weights& weights, double period) {
  Series sum{}, delayed{1};
  for (const double weight : weights) {
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += weight * delayed[i];
    delayed = product(delayed, {1, -period});
  }
  return sum;
}

int samples_of(const TargetSmoothingSettings& s) {
  kRequireSmoothing(s.average >= 0 && s.average <= kLongestAverage, "average", s.average,
                    "0 to 0.1 s");
  return std::max(1, static_cast<int>(std::lround(s.average / s.period)));
}

TargetSmoothingSettings checked(const TargetSmoothingSettings& s) {
  kRequireSmoothing.positive("period", s.period);
  kRequireSmoothing.positive("smoothing", s.smoothing);
  kRequireSmoothing(s.oil_column >= 0 && s.oil_column * s.period < 0.5, "oil_column", s.oil_column,
                    "0 to half of the sampling rate");
  return s;
}

}  // namespace

TargetSmoothing::TargetSmoothing(const TargetSmoothingSettings& settings)
    : smoothing_{checked(settings).smoothing},
      average_{samples_of(settings)},
      notch_{settings.oil_column > 0
                 ? Notch{settings.oil_column, kNotchDamping, kNotchDepth, settings.period}
                 : Notch{}},
      poles_{settings.smoothing, settings.period},
      sharpening_{decltype(sharpening_)::Zero()} {
  const double h = settings.period;
  const std::vector<double> mean(static_cast<std::size_t>(samples_of(settings)),
                                 1.0 / samples_of(settings));
  Series undone =
      product(series_of(notch_.denominator(), h),
              reciprocal(product(series_of(notch_.numerator(), h), series_of(mean, h))));
  for (int pole = 0; pole < kPoles; ++pole) undone = product(undone, {1, smoothing_});
  for (int k = 0; k < kDerivatives; ++k)
    for (int i = 0; k + i < kDerivatives; ++i)
      sharpening_(k, k + i) = undone[static_cast<std::size_t>(i)];
}

void TargetSmoothing::advance(double target) noexcept {
  poles_.advance(notch_(average_(target)));
  double scale = 1;
  for (int k = 0; k < kDerivatives; ++k, scale /= smoothing_)
    smoothed_[k] = scale * poles_.difference(k);
}

TargetSmoothing::Derivatives TargetSmoothing::smoothed_after(double time) const noexcept {
  Derivatives later = smoothed_;
  for (int k = 0; k < kDerivatives; ++k) {
    double term = 1;
    for (int i = 1; k + i < kDerivatives; ++i) {
      term *= time / i;
      later[k] += term * smoothed_[k + i];
    }
  }
  return later;
}

}  // namespace rths::controller
