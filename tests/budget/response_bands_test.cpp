// SPDX-License-Identifier: Apache-2.0
//
// Intervals of parameters carried to the response, against closed forms: a mass m on a spring k
// under a constant ground acceleration a moves by u(t) = −(m a / k) (1 − cos ω t), so that its peak
// is 2 m a / k, and that of the force 2 m a for every k.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include <rths/budget/response_bands.hpp>
#include <rths/maths/statistics.hpp>

namespace rths::budget {
namespace {

constexpr double kMass = 2e5, kStiffness = 4e6, kAcceleration = 0.5;  // [kg], [N/m], [m/s²]
constexpr double kDuration = 3;                                       // [s], two periods

sim::Bearing spring(double stiffness) {
  return {"spring",
          {{"bouc_wen",
            "",
            {{"characteristic_strength", 1e-3},
             {"post_yield_stiffness", stiffness},
             {"yield_displacement", 0.01}}}},
          kMass * 9.80665};
}

UncertainSimulation oscillator() {
  UncertainSimulation simulation;
  sim::PlantMatrices plant;
  plant.M = kMass * Eigen::Matrix2d::Identity();
  plant.C = plant.K = Eigen::Matrix2d::Zero();
  plant.iota = Eigen::Matrix2d::Identity();
  plant.overturning = Eigen::Vector2d::Zero();
  plant.bearings = 1;
  plant.mass_per_bearing = kMass;
  plant.vertical_frequency = 10;
  plant.vertical_damping = 0.05;
  simulation.structure = std::make_shared<sim::StickModel>(plant);
  simulation.motion.time_step = 0.01;
  simulation.motion.long_acceleration.assign(1000, kAcceleration);
  simulation.motion.lat_acceleration.assign(1000, 0);
  simulation.duration = kDuration;
  simulation.fitted = spring(kStiffness);
  return simulation;
}

const PeakBand& peak(const ResponseBands& bands, const std::string& name) {
  for (const auto& one : bands.peaks)
    if (one.name == name) return one;
  throw std::runtime_error{"no peak " + name};
}

constexpr double kPeak = 2 * kMass * kAcceleration / kStiffness;  // [m]

// A deviation of 1 % changes 1/k by 1 % ± 0.01 %.
TEST(ResponseBands, CarryAStiffnessToThePeaksOfAnOscillator) {
  auto simulation = oscillator();
  simulation.deviating = {spring(1.01 * kStiffness), spring(0.99 * kStiffness)};

  const auto bands = response_bands(simulation);

  const auto& displacement = peak(bands, "displacement.long");
  EXPECT_NEAR(displacement.value, kPeak, 1e-3 * kPeak);
  EXPECT_NEAR(displacement.high - displacement.value, maths::kNormal95 * 0.01 * kPeak,
              3e-3 * 0.01 * kPeak);
  EXPECT_NEAR(displacement.value - displacement.low, displacement.high - displacement.value,
              1e-12 * kPeak);
  const auto& force = peak(bands, "force.long");
  EXPECT_NEAR(force.value, 2 * kMass * kAcceleration, 1e-3 * force.value);
  EXPECT_LT(force.high - force.low, 1e-4 * force.value);
  EXPECT_EQ(bands.runs, 3);
  EXPECT_FALSE(bands.has_remainder);
}

// Two independent parameters: their variances add up.
TEST(ResponseBands, AddTheVariancesOfIndependentDirections) {
  auto simulation = oscillator();
  simulation.deviating = {spring(1.003 * kStiffness), spring(0.997 * kStiffness),
                          spring(1.004 * kStiffness), spring(0.996 * kStiffness)};

  const auto& band = peak(response_bands(simulation), "displacement.long");

  EXPECT_NEAR(band.high - band.value, maths::kNormal95 * 0.005 * kPeak, 3e-3 * 0.005 * kPeak);
}

// A constant remainder c moves the peak by 2 c / k, in either sense.
TEST(ResponseBands, CountTheRemainderAsAForceOfItsSize) {
  constexpr double kRemainder = 1000;  // [N]
  auto simulation = oscillator();
  simulation.remainder.assign(500, Eigen::Vector2d{kRemainder, 0});

  const auto bands = response_bands(simulation);

  const auto& band = peak(bands, "displacement.long");
  const double change = 2 * kRemainder / kStiffness;
  EXPECT_NEAR(band.high - band.value, maths::kNormal95 * change, 2e-3 * change);
  EXPECT_EQ(bands.runs, 9);
  EXPECT_TRUE(bands.has_remainder);
}

TEST(ResponseBands, AreTheSameEveryTime) {
  auto simulation = oscillator();
  simulation.deviating = {spring(1.01 * kStiffness), spring(0.99 * kStiffness)};
  simulation.remainder = {Eigen::Vector2d{500, 0}, Eigen::Vector2d{-300, 0}};

  const auto one = response_bands(simulation), other = response_bands(simulation);

  for (std::size_t i = 0; i < one.peaks.size(); ++i) {
    EXPECT_EQ(one.peaks[i].low, other.peaks[i].low);
    EXPECT_EQ(one.peaks[i].high, other.peaks[i].high);
  }
}

// Tests of the same spring under noise: each fits a stiffness to its own force by least squares,
// with the variance of its own residual. Of 100 intervals of 95 %, fewer than 88 contain the truth
// once in 300 series.
TEST(ResponseBands, ContainTheTruePeakAsOftenAsTheyState) {
  constexpr int kTests = 100, kRows = 60;
  constexpr double kNoise = 8000;  // [N]
  std::mt19937_64 generator{7};
  std::normal_distribution<double> noise{0, kNoise};
  int contained = 0;
  for (int test = 0; test < kTests; ++test) {
    double uu = 0, uf = 0, ff = 0;
    for (int row = 0; row < kRows; ++row) {
      const double u = 0.05 * std::sin(0.3 * row), f = kStiffness * u + noise(generator);
      uu += u * u, uf += u * f, ff += f * f;
    }
    const double fitted = uf / uu, deviation = std::sqrt((ff - uf * uf / uu) / (kRows - 1) / uu);
    auto simulation = oscillator();
    simulation.time_step = 0.005;
    simulation.fitted = spring(fitted);
    simulation.deviating = {spring(fitted + deviation), spring(fitted - deviation)};
    const auto& band = peak(response_bands(simulation), "displacement.long");
    contained += band.low <= kPeak && kPeak <= band.high ? 1 : 0;
  }
  EXPECT_GE(contained, 88);
  EXPECT_LT(contained, kTests) << "intervals of 95 % that always contain the truth are too wide";
}

// Spectra exist for each floor, with a band around the value.
TEST(ResponseBands, SurroundTheSpectrumOfEachFloor) {
  auto simulation = oscillator();
  simulation.structure = std::make_shared<sim::StickModel>(sim::example_plant());
  simulation.fitted = spring(4e6);
  simulation.deviating = {spring(4.1e6), spring(3.9e6)};
  simulation.time_step = 0.005;

  const auto bands = response_bands(simulation);

  ASSERT_EQ(bands.spectra.size(), 3U);
  for (const auto& spectrum : bands.spectra) {
    ASSERT_EQ(spectrum.value.size(), bands.frequencies.size());
    for (std::size_t i = 0; i < spectrum.value.size(); ++i) {
      EXPECT_LE(spectrum.low[i], spectrum.value[i]);
      EXPECT_GE(spectrum.high[i], spectrum.value[i]);
    }
    EXPECT_GT(spectrum.high[0] - spectrum.low[0], 0);
  }
}

}  // namespace
}  // namespace rths::budget
