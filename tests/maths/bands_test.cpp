// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <complex>
#include <random>

#include <gtest/gtest.h>

#include <rths/maths/bands.hpp>

namespace rths::maths {
namespace {

constexpr double kInterval = 1e-3;   // [s]
constexpr double kDeadTime = 0.007;  // [s]
constexpr double kLag = 0.012;       // time constant [s]

std::complex<double> filter(double frequency) {
  const std::complex<double> s{0, 2 * M_PI * frequency};
  return std::exp(-s * kDeadTime) / (1.0 + s * kLag);
}

/// A sum of sines, and the same behind a dead time and a first-order lag, in closed form.
struct Filtered {
  explicit Filtered(const std::vector<std::pair<double, double>>& sines, double duration = 40) {
    for (double t = 0; t < duration; t += kInterval) {
      double x = 0, y = 0;
      for (const auto& [frequency, amplitude] : sines) {
        const auto response =
            amplitude * filter(frequency) * std::polar(1.0, 2 * M_PI * frequency * t);
        x += amplitude * std::sin(2 * M_PI * frequency * t);
        y += response.imag();
      }
      command.push_back(x);
      measured.push_back(y);
    }
  }
  std::vector<double> command, measured;
};

double largest_of(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST(Bands, HaveTheGainAndDelayOfADeadTimeWithALag) {
  const std::vector<std::pair<double, double>> sines{{0.5, 1}, {2, 0.5}, {4.25, 0.3}, {8, 0.2}};
  const Filtered signals{sines};

  const auto bands = track_bands(signals.command, signals.measured, kInterval, 0.019);

  for (std::size_t i = 0; i < sines.size(); ++i) {
    const double frequency = sines[i].first;
    ASSERT_TRUE(bands[i].response) << frequency;
    EXPECT_LE(bands[i].from, frequency);
    EXPECT_GT(bands[i].to, frequency);
    // The sines lie on frequencies of the spectra; the window's leakage is below a thousandth.
    EXPECT_NEAR(bands[i].response->gain, std::abs(filter(frequency)), 1e-3);
    EXPECT_NEAR(bands[i].response->delay, -std::arg(filter(frequency)) / (2 * M_PI * frequency),
                5e-5);
    EXPECT_NEAR(bands[i].response->coherence, 1, 1e-3);
    EXPECT_NEAR(bands[i].command * largest_of(signals.command), sines[i].second / std::sqrt(2.0),
                1e-3);
    const double error = sines[i].second * std::abs(filter(frequency) - 1.0) / std::sqrt(2.0);
    EXPECT_NEAR(bands[i].nrms * largest_of(signals.command), error, 0.02 * error);
  }
}

TEST(Bands, ShareTheWholeErrorAmongThem) {
  const Filtered signals{{{0.31, 1}, {2.7, 0.5}, {5.9, 0.3}, {14.2, 0.2}, {61, 0.1}}, 23.7};
  double square = 0;
  for (std::size_t i = 0; i < signals.command.size(); ++i)
    square += std::pow(signals.measured[i] - signals.command[i], 2);
  const double nrms =
      std::sqrt(square / static_cast<double>(signals.command.size())) / largest_of(signals.command);

  double shares = 0;
  for (const auto& band : track_bands(signals.command, signals.measured, kInterval, 0.019))
    shares += band.nrms * band.nrms;

  EXPECT_NEAR(std::sqrt(shares), nrms, 1e-12);
}

TEST(Bands, FindADelayOfMoreThanHalfAPeriod) {
  const Filtered signals{{{0.5, 1}, {9, 0.2}}};
  std::vector<double> late(signals.command.size());
  constexpr std::size_t kShift = 60;  // 60 ms: 0.54 periods of 9 Hz
  for (std::size_t i = kShift; i < late.size(); ++i) late[i] = signals.command[i - kShift];

  const auto bands = track_bands(signals.command, late, kInterval, 0.060);

  ASSERT_TRUE(bands[3].response);
  EXPECT_NEAR(bands[3].response->delay, 0.060, 1e-4);
}

TEST(Bands, HaveNoResponseWhereTheCommandHasNoEnergy) {
  const Filtered signals{{{0.5, 1}, {4.25, 0.3}}};

  const auto bands = track_bands(signals.command, signals.measured, kInterval, 0.019);

  EXPECT_TRUE(bands[0].response);
  EXPECT_FALSE(bands[1].response);
  EXPECT_TRUE(bands[2].response);
  EXPECT_FALSE(bands[5].response);
}

TEST(Bands, LoseCoherenceToNoiseOfTheMeasurement) {
  std::mt19937_64 random{7};
  std::normal_distribution<double> normal;
  std::vector<double> command(60'000), measured;
  for (double& value : command) value = normal(random);
  for (const double value : command) measured.push_back(value + normal(random));

  const auto bands = track_bands(command, measured, kInterval, 0);

  // Equal powers of signal and noise: 1/2, biased by about (1 − 1/2)²/29 for 29 segments.
  ASSERT_TRUE(bands[3].response);
  EXPECT_NEAR(bands[3].response->coherence, 0.5, 0.06);
  EXPECT_NEAR(bands[3].response->gain, 1, 0.1);
}

TEST(Bands, EndAtHalfTheSamplingRate) {
  const std::vector<double> slow(1000, 1.0);

  const auto bands = track_bands(slow, slow, 0.1, 0);

  ASSERT_EQ(bands.size(), 3U);
  EXPECT_EQ(bands[2].from, 3);
  EXPECT_EQ(bands[2].to, 5);
}

TEST(Bands, HaveNoResponseInARecordTooShortToAverage) {
  const Filtered signals{{{0.5, 1}, {4.25, 0.3}}, 6};

  for (const auto& band : track_bands(signals.command, signals.measured, kInterval, 0.019))
    EXPECT_FALSE(band.response);
}

// A test may end after its first step.
TEST(Bands, TakeTheShortestRecordings) {
  for (const std::size_t rows : {1U, 2U, 3U}) {
    const std::vector<double> command(rows, 2), measured(rows, 1);
    const auto bands = track_bands(command, measured, kInterval, 0);
    ASSERT_FALSE(bands.empty());
    EXPECT_GT(bands[0].nrms, 0) << rows;
    for (const auto& band : bands) EXPECT_LE(band.nrms, 0.5) << rows;
  }
}

// White signals: S/(S + N) at each frequency.
TEST(Coherence, IsTheShareOfTheCommandInTheMeasurement) {
  std::mt19937_64 random{8};
  std::normal_distribution<double> normal;
  constexpr double kNoise = 0.5;
  std::vector<double> command(120'000), measured;
  for (double& value : command) value = normal(random);
  for (const double value : command) measured.push_back(value + kNoise * normal(random));

  const Coherence coherence = coherence_of(command, measured, kInterval);

  double mean = 0;
  for (const double value : coherence.value)
    mean += value / static_cast<double>(coherence.value.size());
  // 59 overlapping segments count as about 31: a bias of (1 − 0.8)²/31.
  EXPECT_NEAR(mean, 1 / (1 + kNoise * kNoise), 0.005);
  EXPECT_EQ(coherence.frequency.front(), 0.25);
  EXPECT_EQ(coherence.frequency.back(), 500);
}

TEST(Coherence, HasItsLeastValueInARange) {
  const Coherence coherence{{1, 2, 3, 4}, {0.2, 0.9, 0.8, 0.1}};

  EXPECT_EQ(coherence.least(2, 3), 0.8);
  EXPECT_EQ(coherence.least(1, 4), 0.1);
  EXPECT_FALSE(coherence.least(4.5, 9));
}

TEST(Coherence, IsEmptyInARecordTooShortToAverage) {
  const Filtered signals{{{0.5, 1}}, 6};

  EXPECT_TRUE(coherence_of(signals.command, signals.measured, kInterval).value.empty());
  EXPECT_TRUE(coherence_of({}, {}, kInterval).value.empty());
}

}  // namespace
}  // namespace rths::maths
