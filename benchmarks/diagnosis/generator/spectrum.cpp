// SPDX-License-Identifier: Apache-2.0
#include "spectrum.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <utility>

namespace trial {
namespace {

void reverse_bits(Spectrum& spectrum) {
  for (std::size_t i = 1, j = 0; i < spectrum.size(); ++i) {
    std::size_t bit = spectrum.size() >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(spectrum[i], spectrum[j]);
  }
}

void butterfly(std::complex<double>& even, std::complex<double>& odd,
               const std::complex<double>& w) {
  // Written out: the library's complex product checks for infinities.
  const std::complex<double> turned{odd.real() * w.real() - odd.imag() * w.imag(),
                                    odd.real() * w.imag() + odd.imag() * w.real()};
  odd = even - turned;
  even += turned;
}

}  // namespace

void fourier(Spectrum& spectrum, bool inverse) {
  reverse_bits(spectrum);
  const std::size_t n = spectrum.size();
  const double turn = (inverse ? 2 : -2) * std::numbers::pi / static_cast<double>(n);
  Spectrum turns(n / 2);
  for (std::size_t k = 0; k < turns.size(); ++k)
    turns[k] = std::polar(1.0, turn * static_cast<double>(k));
  for (std::size_t half = 1; half < n; half *= 2)
    for (std::size_t start = 0; start < n; start += 2 * half)
      for (std::size_t k = 0; k < half; ++k)
        butterfly(spectrum[start + k], spectrum[start + half + k], turns[k * (n / (2 * half))]);
}

Spectrum spectrum_of(const Signal& signal) {
  Spectrum spectrum(std::bit_ceil(signal.size() + signal.size() / 4));
  const std::size_t padding = spectrum.size() - signal.size();
  for (std::size_t k = 0; k < signal.size(); ++k) spectrum[k] = signal[k];
  for (std::size_t k = 0; k < padding; ++k) {
    const double share = static_cast<double>(k + 1) / static_cast<double>(padding + 1);
    const double back = 0.5 - 0.5 * std::cos(std::numbers::pi * share);
    spectrum[signal.size() + k] = signal.back() + back * (signal.front() - signal.back());
  }
  fourier(spectrum, false);
  return spectrum;
}

Signal filtered(const Spectrum& spectrum, double sample_time, std::size_t samples,
                const std::function<std::complex<double>(double)>& response) {
  const std::size_t n = spectrum.size();
  Spectrum shaped(n);
  for (std::size_t k = 0; k <= n / 2; ++k) {
    const double frequency = static_cast<double>(k) / (static_cast<double>(n) * sample_time);
    shaped[k] = spectrum[k] * response(frequency);
    if (k > 0 && k < n / 2) shaped[n - k] = std::conj(shaped[k]);
  }
  fourier(shaped, true);
  Signal signal(samples);
  for (std::size_t k = 0; k < samples; ++k) signal[k] = shaped[k].real() / static_cast<double>(n);
  return signal;
}

Signal compared(const Signal& signal, double sample_time) {
  constexpr double kReach = 0.16;  // of the window on each side [s]
  const auto taps = static_cast<std::ptrdiff_t>(kReach / sample_time);
  Signal weight;
  double sum = 0;
  for (std::ptrdiff_t k = -taps; k <= taps; ++k) {
    const double t = static_cast<double>(k) * sample_time;
    const double phase = 2 * std::numbers::pi * kCompareBand * t;
    const double sinc = k == 0 ? 1 : std::sin(phase) / phase;
    weight.push_back(sinc * (0.54 + 0.46 * std::cos(std::numbers::pi * t / kReach)));
    sum += weight.back();
  }
  const auto samples = static_cast<std::ptrdiff_t>(signal.size());
  const auto stride = static_cast<std::ptrdiff_t>(std::lround(1 / (kCompareRate * sample_time)));
  Signal result;
  for (std::ptrdiff_t centre = 0; centre < samples; centre += stride) {
    double value = 0;
    for (std::ptrdiff_t k = -taps; k <= taps; ++k) {
      const std::ptrdiff_t at = std::clamp<std::ptrdiff_t>(centre + k, 0, samples - 1);
      value += weight[static_cast<std::size_t>(k + taps)] * signal[static_cast<std::size_t>(at)];
    }
    result.push_back(value / sum);
  }
  return result;
}

Signal axis_of(const std::vector<Plane>& planes, std::size_t axis) {
  Signal signal;
  signal.reserve(planes.size());
  for (const Plane& plane : planes) signal.push_back(plane[axis]);
  return signal;
}

}  // namespace trial
