// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <rths/sim/floor_spectrum.hpp>

#include "support/files.hpp"

namespace rths::sim {
namespace {

constexpr double kDampingRatio = 0.05;

std::vector<double> sine(double frequency, double step, double duration, double amplitude = 1) {
  std::vector<double> values;
  for (int i = 0; i * step < duration; ++i)
    values.push_back(amplitude * std::sin(2 * std::numbers::pi * frequency * i * step));
  return values;
}

// A very stiff oscillator moves with the floor.
TEST(FloorSpectrum, EqualsThePeakAccelerationForStiffOscillators) {
  const auto a = sine(1.0, 0.001, 5, 3);
  const std::vector<double> zero(a.size(), 0.0);
  const std::vector<double> stiff = {200};

  EXPECT_NEAR(floor_spectrum(a, zero, 0.001, stiff, kDampingRatio)[0], 3, 0.01);
}

// In steady resonance the absolute acceleration is √(1 + 4ζ²)/(2ζ) times the floor's.
TEST(FloorSpectrum, AmplifiesAtResonanceByTheClosedForm) {
  const auto a = sine(2.0, 0.002, 60);
  const std::vector<double> zero(a.size(), 0.0);
  const std::vector<double> resonant = {2.0};

  const double expected = std::sqrt(1 + 4 * kDampingRatio * kDampingRatio) / (2 * kDampingRatio);
  EXPECT_NEAR(floor_spectrum(a, zero, 0.002, resonant, kDampingRatio)[0], expected,
              0.01 * expected);
}

TEST(FloorSpectrum, HasTheTransmissibilityOfAnOscillatorAwayFromResonance) {
  const double drive = 1.0;
  const auto a = sine(drive, 0.002, 80);
  const std::vector<double> zero(a.size(), 0.0);
  // The peak over time includes the transient, so compare frequencies where it contributes little.
  const std::vector<double> own = {6.0};
  const double r = drive / own[0];
  const double z2r = 2 * kDampingRatio * r;
  const double expected = std::sqrt((1 + z2r * z2r) / ((1 - r * r) * (1 - r * r) + z2r * z2r));

  const double found = floor_spectrum(a, zero, 0.002, own, kDampingRatio)[0];

  EXPECT_GE(found, expected * 0.999);
  EXPECT_LT(found, expected * 1.2);
}

// Rotating the motion by any angle keeps the spectrum, which is a vector's length.
TEST(FloorSpectrum, IsThePeakOfTheVectorNotOfTheAxes) {
  const auto a = sine(1.3, 0.002, 20);
  std::vector<double> along;
  std::vector<double> across;
  for (const double value : a) {
    along.push_back(value * std::cos(0.6));
    across.push_back(value * std::sin(0.6));
  }
  const std::vector<double> zero(a.size(), 0.0);
  const auto frequencies = spectrum_frequencies(0.5, 20, 12);

  const auto straight = floor_spectrum(a, zero, 0.002, frequencies, kDampingRatio);
  const auto turned = floor_spectrum(along, across, 0.002, frequencies, kDampingRatio);

  for (std::size_t i = 0; i < frequencies.size(); ++i)
    EXPECT_NEAR(straight[i], turned[i], 1e-9 * straight[i]);
}

// Exact for acceleration linear between samples: finer sampling of the same motion only changes the
// distance of a sample to the peak.
TEST(FloorSpectrum, IsExactForLinearInterpolation) {
  const auto coarse = sine(1.7, 0.02, 10);
  std::vector<double> fine;
  for (std::size_t i = 0; i + 1 < coarse.size(); ++i)
    for (int k = 0; k < 10; ++k) fine.push_back(coarse[i] + (coarse[i + 1] - coarse[i]) * k / 10.0);
  const std::vector<double> frequencies = {0.5, 1.7, 12, 24};
  const auto from_coarse = floor_spectrum(coarse, std::vector<double>(coarse.size(), 0.0), 0.02,
                                          frequencies, kDampingRatio);
  const auto from_fine = floor_spectrum(fine, std::vector<double>(fine.size(), 0.0), 0.002,
                                        frequencies, kDampingRatio);

  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    // With 20 points or more per period, the nearest misses a peak by at most 1 − cos(π/20).
    const double missed = 1 - std::cos(std::numbers::pi / 20);
    EXPECT_NEAR(from_coarse[i], from_fine[i], missed * from_fine[i]);
  }
}

TEST(SpectrumFrequencies, AreEvenInTheirLogarithm) {
  const auto f = spectrum_frequencies(0.1, 10, 3);

  ASSERT_EQ(f.size(), 3U);
  EXPECT_NEAR(f[1], 1, 1e-12);
  EXPECT_NEAR(f[2], 10, 1e-12);
}

TEST(FloorSpectrum, RefusesDirectionsOfDifferentLength) {
  const std::vector<double> a(10, 0.0);
  const std::vector<double> b(9, 0.0);
  const std::vector<double> f = {1};

  EXPECT_NE(test::error_of([&] { static_cast<void>(floor_spectrum(a, b, 0.01, f, 0.05)); }), "");
}

}  // namespace
}  // namespace rths::sim
