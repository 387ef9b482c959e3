// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/signal.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>
#include <rths/maths/fourier.hpp>
#include <rths/maths/low_pass.hpp>

namespace rths::diagnosis {
namespace {

constexpr int kSettlingPeriods = 6;  // of the cut-off: settling time of a filter

// The signal with its odd reflection on both sides: value and slope continue without a step.
VectorXd reflected(const VectorXd& x, Index margin) {
  const Index n = x.size();
  VectorXd longer(n + 2 * margin);
  for (Index i = 0; i < margin; ++i) {
    longer[margin - 1 - i] = 2 * x[0] - x[i + 1];
    longer[margin + n + i] = 2 * x[n - 1] - x[n - 2 - i];
  }
  longer.segment(margin, n) = x;
  return longer;
}

// Samples by which reflections extend a signal at each end.
Index margin_of(Index samples, double cutoff, double time_step) {
  const auto settling = static_cast<Index>(kSettlingPeriods / (cutoff * time_step));
  return std::min(settling, samples - 1);
}

void run(maths::LowPass filter, VectorXd& x) {
  // The filter starts at rest, at the level of the first sample.
  const double level = x[0];
  x.array() -= level;
  filter.filter({x.data(), static_cast<std::size_t>(x.size())});
  x.array() += level;
}

constexpr Index kTogether = 4;
using Together = std::vector<std::array<double, kTogether>>;

void run_together(const maths::LowPass& filter, Together& x) {
  const auto level = x[0];
  for (auto& samples : x)
    for (std::size_t i = 0; i < kTogether; ++i) samples[i] -= level[i];
  filter.filter_four(x);
  for (auto& samples : x)
    for (std::size_t i = 0; i < kTogether; ++i) samples[i] += level[i];
}

// Displacement and velocity at one end of a motion.
struct End {
  double u, v;
};

// From samples that are given from the end on: a line is fitted to the displacement less the double
// integral of the acceleration.
// @param time_step  negative if the samples run against time
End end_of(const VectorXd& displacement, const VectorXd& acceleration, double time_step) {
  const Index n = displacement.size();
  const VectorXd time = VectorXd::LinSpaced(n, 0, time_step * static_cast<double>(n - 1));
  VectorXd line = displacement;
  double velocity = 0, integral = 0;
  for (Index i = 1; i < n; ++i) {
    const double mean = 0.5 * (acceleration[i - 1] + acceleration[i]);
    integral += time_step * (velocity + 0.5 * time_step * mean);
    velocity += time_step * mean;
    line[i] -= integral;
  }
  const VectorXd about = time.array() - time.mean();
  const double slope = about.dot(line) / about.squaredNorm();
  return {line.mean() - slope * time.mean(), slope};
}

// The cubic that leads from one end to another in a duration.
class Bridge {
 public:
  Bridge(const End& from, const End& to, double duration)
      : from_{from},
        square_{(3 * (to.u - from.u) / duration - 2 * from.v - to.v) / duration},
        cube_{(from.v + to.v - 2 * (to.u - from.u) / duration) / (duration * duration)} {}
  [[nodiscard]] double displacement(double t) const {
    return from_.u + t * (from_.v + t * (square_ + t * cube_));
  }
  [[nodiscard]] double acceleration(double t) const { return 2 * square_ + 6 * t * cube_; }

 private:
  End from_;
  double square_, cube_;
};

// Burg's reflection coefficient of order k + 1, from forward and backward prediction errors. The
// backward error of a sample is stored with the oldest sample that it predicts from.
double reflection_of(const std::vector<VectorXd>& forward, const std::vector<VectorXd>& backward,
                     int k, double least) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < forward.size(); ++i) {
    const Index n = forward[i].size() - k - 1;
    if (n <= 0) continue;
    const auto f = forward[i].tail(n);
    const auto b = backward[i].head(n);
    product += 2 * f.dot(b);
    square += f.squaredNorm() + b.squaredNorm() + 2 * least * static_cast<double>(n);
  }
  return square > 0 ? product / square : 0;
}

constexpr Index kStretch = 256;
using Stretch = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kStretch, 1>;

// Prediction errors of the next order.
void reflect(std::vector<VectorXd>& forward, std::vector<VectorXd>& backward, int k,
             double reflection) {
  for (std::size_t i = 0; i < forward.size(); ++i) {
    const Index n = forward[i].size() - k - 1;
    // In stretches that stay in the cache.
    for (Index first = 0; first < n; first += kStretch) {
      const Index size = std::min(kStretch, n - first);
      auto f = forward[i].segment(k + 1 + first, size);
      auto b = backward[i].segment(first, size);
      const Stretch before = f;
      f -= reflection * b;
      b -= reflection * before;
    }
  }
}

// Sum of the spectral densities of signals.
VectorXd density_of(const std::vector<VectorXd>& signals, int window, double time_step) {
  VectorXd sum = VectorXd::Zero(window / 2 + 1);
  for (const auto& signal : signals) sum += power_spectrum(signal, window, time_step).density;
  return sum;
}

}  // namespace

VectorXd low_passed(const VectorXd& signal, int order, double cutoff, double time_step) {
  if (signal.size() < 2) throw Error{"low-pass: expected at least 2 samples"};
  const maths::LowPass filter{order, cutoff, time_step};
  const Index margin = margin_of(signal.size(), cutoff, time_step);
  VectorXd x = reflected(signal, margin);
  run(filter, x);
  x.reverseInPlace();
  run(filter, x);
  x.reverseInPlace();
  return x.segment(margin, signal.size());
}

MatrixXd low_passed_columns(const MatrixXd& signals, int order, double cutoff, double time_step) {
  MatrixXd result(signals.rows(), signals.cols());
  if (signals.cols() == 1) {
    result.col(0) = low_passed(signals.col(0), order, cutoff, time_step);
    return result;
  }
  if (signals.rows() < 2) throw Error{"low-pass: expected at least 2 samples"};
  const maths::LowPass filter{order, cutoff, time_step};
  const Index margin = margin_of(signals.rows(), cutoff, time_step);
  Together x(static_cast<std::size_t>(signals.rows() + 2 * margin));
  for (Index first = 0; first < signals.cols(); first += kTogether) {
    const Index columns = std::min(kTogether, signals.cols() - first);
    for (Index i = 0; i < columns; ++i) {
      const VectorXd longer = reflected(signals.col(first + i), margin);
      for (std::size_t k = 0; k < x.size(); ++k)
        x[k][static_cast<std::size_t>(i)] = longer[static_cast<Index>(k)];
    }
    run_together(filter, x);
    std::reverse(x.begin(), x.end());
    run_together(filter, x);
    for (Index i = 0; i < columns; ++i)
      for (Index k = 0; k < signals.rows(); ++k)
        result(k, first + i) =
            x[x.size() - 1 - static_cast<std::size_t>(margin + k)][static_cast<std::size_t>(i)];
  }
  return result;
}

VectorXd thinned(const VectorXd& signal, int factor) {
  return signal(Eigen::seqN(0, (signal.size() + factor - 1) / factor, factor));
}

VectorXd rate_of(const VectorXd& x, double time_step) {
  const Index n = x.size();
  VectorXd rate = VectorXd::Zero(n);
  if (n < 2) return rate;
  rate[0] = (x[1] - x[0]) / time_step;
  rate[n - 1] = (x[n - 1] - x[n - 2]) / time_step;
  if (n > 2) rate.segment(1, n - 2) = (x.tail(n - 2) - x.head(n - 2)) / (2 * time_step);
  if (n > 4)
    rate.segment(2, n - 4) =
        (8 * (x.segment(3, n - 4) - x.segment(1, n - 4)) - (x.tail(n - 4) - x.head(n - 4))) /
        (12 * time_step);
  return rate;
}

VectorXd second_rate_of(const VectorXd& x, double time_step) {
  const Index n = x.size();
  VectorXd rate = VectorXd::Zero(n);
  const double square = time_step * time_step;
  if (n > 2)
    rate.segment(1, n - 2) = (x.tail(n - 2) - 2 * x.segment(1, n - 2) + x.head(n - 2)) / square;
  if (n > 4)
    rate.segment(2, n - 4) = (16 * (x.segment(3, n - 4) + x.segment(1, n - 4)) -
                              30 * x.segment(2, n - 4) - x.tail(n - 4) - x.head(n - 4)) /
                             (12 * square);
  return rate;
}

VectorXd fused(const VectorXd& displacement, const VectorXd& acceleration, double crossover,
               double time_step) {
  const Index n = displacement.size();
  if (acceleration.size() != n) throw Error{"fusing motion: the channels differ in length"};
  // A transform is periodic: a quarter more samples lead the end back to the beginning, in both
  // channels, as one motion.
  const Index margin = maths::fast_length(n + n / 4 + 1) - n;
  VectorXd u = VectorXd::Zero(n + margin), a = VectorXd::Zero(n + margin);
  u.head(n) = displacement;
  a.head(n) = acceleration;
  const Index near =
      std::clamp<Index>(static_cast<Index>(1 / (crossover * time_step)), std::min<Index>(3, n), n);
  if (near > 1) {
    const Bridge bridge{
        end_of(displacement.tail(near).reverse(), acceleration.tail(near).reverse(), -time_step),
        end_of(displacement.head(near), acceleration.head(near), time_step),
        time_step * static_cast<double>(margin + 1)};
    for (Index i = 0; i < margin; ++i) {
      const double time = time_step * static_cast<double>(i + 1);
      u[n + i] = bridge.displacement(time);
      a[n + i] = bridge.acceleration(time);
    }
  }
  VectorXcd U = maths::spectrum(u);
  const VectorXcd A = maths::spectrum(a);
  const double period = time_step * static_cast<double>(n + margin);
  const double corner = std::pow(crossover, 4);
  for (Index k = 0; k < U.size(); ++k) {
    const Index bin = std::min(k, U.size() - k);
    const double f = static_cast<double>(bin) / period;
    const double square = f * f;
    const double sum = square * square + corner;
    U[k] =
        U[k] * (corner / sum) - A[k] * (square / sum / (4 * std::numbers::pi * std::numbers::pi));
  }
  return maths::signal_of(U).head(n);
}

VectorXd AutoRegression::whitened(const VectorXd& signal) const {
  VectorXd e(signal.size());
  for (Index t = 0; t < signal.size(); ++t) {
    double innovation = signal[t];
    for (Index i = 0; i < std::min(coefficients.size(), t); ++i)
      innovation -= coefficients[i] * signal[t - 1 - i];
    e[t] = innovation / deviation;
  }
  return e;
}

VectorXd AutoRegression::coloured(const VectorXd& innovations) const {
  VectorXd x(innovations.size());
  for (Index t = 0; t < x.size(); ++t) {
    x[t] = deviation * innovations[t];
    for (Index i = 0; i < std::min(coefficients.size(), t); ++i)
      x[t] += coefficients[i] * x[t - 1 - i];
  }
  return x;
}

AutoRegression auto_regression(const std::vector<VectorXd>& stretches, int order, double ridge) {
  std::vector<VectorXd> forward, backward;
  double variance = 0;
  Index samples = 0;
  for (const auto& stretch : stretches) {
    const VectorXd x = stretch.array() - stretch.mean();
    forward.push_back(x);
    backward.push_back(x);
    variance += x.squaredNorm();
    samples += x.size();
  }
  if (samples < Index{2} * order) throw Error{"noise model: too few samples at rest"};
  variance /= static_cast<double>(samples);
  const double least = ridge * variance;
  variance += least;
  AutoRegression model{VectorXd::Zero(order), 0};
  for (int k = 0; k < order && variance > 0; ++k) {
    const double reflection = reflection_of(forward, backward, k, least);
    const VectorXd before = model.coefficients;
    model.coefficients[k] = reflection;
    for (int i = 0; i < k; ++i) model.coefficients[i] -= reflection * before[k - 1 - i];
    variance *= 1 - reflection * reflection;
    reflect(forward, backward, k, reflection);
  }
  model.deviation = std::sqrt(std::max(variance, 0.0));
  return model;
}

Spectrum power_spectrum(const VectorXd& signal, int window, double time_step) {
  if (signal.size() < window) throw Error{"spectrum: the signal is shorter than its window"};
  const VectorXd weight = maths::hann_window(window, 0);
  const int bins = window / 2 + 1;
  Spectrum spectrum{VectorXd::LinSpaced(bins, 0, 0.5 / time_step), VectorXd::Zero(bins)};
  const double mean = signal.mean();
  int windows = 0;
  for (Index first = 0; first + window <= signal.size(); first += window / 2, ++windows) {
    const VectorXd windowed = (signal.segment(first, window).array() - mean) * weight.array();
    spectrum.density += maths::half_spectrum(windowed).cwiseAbs2();
  }
  spectrum.density *= 2 * time_step / (weight.squaredNorm() * windows);
  spectrum.density[0] /= 2;
  spectrum.density[bins - 1] /= 2;
  return spectrum;
}

double noise_begins(const std::vector<VectorXd>& signals, const std::vector<VectorXd>& at_rest,
                    double time_step) {
  constexpr Index kLongest = 1024, kShortest = 64;
  constexpr double kMostRatio = 2;  // of densities
  Index samples = kLongest;
  for (const auto* all : {&signals, &at_rest})
    for (const auto& signal : *all) samples = std::min(samples, signal.size());
  double high = 0.5 / time_step;
  if (samples < kShortest) return high;
  int window = kShortest;
  while (Index{2} * window <= samples) window *= 2;
  const VectorXd moving = density_of(signals, window, time_step),
                 still = density_of(at_rest, window, time_step);
  for (Index last = moving.size(); last > 0;) {
    const double low = high / std::cbrt(2.0);
    const auto first = static_cast<Index>(std::floor(low * window * time_step)) + 1;
    const Index bins = last - first;
    if (bins <= 0 ||
        !(moving.segment(first, bins).sum() < kMostRatio * still.segment(first, bins).sum()))
      break;
    high = low;
    last = first;
  }
  return high;
}

}  // namespace rths::diagnosis
