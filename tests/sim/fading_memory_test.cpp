// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/sim/dual.hpp>

#include "sim/src/terms/fading_memory.hpp"
#include "support/realtime_guard.hpp"

namespace rths::sim {
namespace {

constexpr double kPowers[] = {0.1, 0.2, 1.0 / 3, 0.5, 0.8, 0.95};
constexpr double kTimeSteps[] = {1e-4, 1e-3, 1e-2};

TEST(FadingMemory, IsThePowerOfTimeFromTheTimeStepToTheLongestMemory) {
  for (const double power : kPowers)
    for (const double shortest : kTimeSteps) {
      const auto exponentials = fading_exponentials(power, shortest, kLongestMemory);
      // At times far denser than those of the fit.
      for (double t = shortest; t < kLongestMemory; t *= 1.003) {
        double sum = 0;
        for (const auto& [rate, weight] : exponentials) sum += weight * std::exp(-rate * t);
        ASSERT_NEAR(sum * std::pow(t, power), 1, 5e-4) << "t^-" << power << " at " << t << " s";
      }
    }
}

TEST(FadingMemory, HasNoNegativeWeights) {
  for (const double power : kPowers)
    for (const double shortest : kTimeSteps)
      for (const auto& [rate, weight] : fading_exponentials(power, shortest, kLongestMemory)) {
        EXPECT_GE(weight, 0);
        EXPECT_GT(rate, 0);
      }
}

// A constant flux from t = 0: M = q t^(1−p)/(1−p), from the first step on.
TEST(FadingMemory, RespondsToAStepOfFluxFromTheFirstTimeStepToAMinute) {
  for (const double power : kPowers)
    for (const double dt : kTimeSteps) {
      std::array<double, kFadingConstants> constants{};
      std::array<double, kFadingStates> memory{};
      prepare_fading_memory(power, dt, constants);
      for (int i = 1; i * dt <= 60; ++i) {
        const double expected = 3 * std::pow(i * dt, 1 - power) / (1 - power);
        ASSERT_NEAR(remember(constants.data(), memory.data(), 3.0), expected, 5e-4 * expected)
            << "t^-" << power << ", step " << i << " of " << dt << " s";
      }
    }
}

// A pulse of flux between 0 and 1 s: M = q (t^(1−p) − (t − 1)^(1−p))/(1−p) afterwards.
TEST(FadingMemory, ForgetsAPulseAsThePowerLawDoes) {
  const double dt = 1e-3, power = 0.5;
  std::array<double, kFadingConstants> constants{};
  std::array<double, kFadingStates> memory{};
  prepare_fading_memory(power, dt, constants);
  for (int i = 1; i <= 60'000; ++i) {
    const double found = remember(constants.data(), memory.data(), i <= 1000 ? 1.0 : 0.0);
    if (i <= 1000) continue;
    const double t = i * dt;
    const double expected = 2 * (std::sqrt(t) - std::sqrt(t - 1));
    ASSERT_NEAR(found, expected, 5e-4 * expected) << t << " s";
  }
}

TEST(FadingMemory, CarriesDerivativesOfTheFlux) {
  std::array<double, kFadingConstants> constants{};
  std::array<Dual, kFadingStates> memory{};
  prepare_fading_memory(0.5, 1e-3, constants);
  for (int i = 1; i <= 100; ++i) {
    const Dual found = remember(constants.data(), memory.data(), 3.0 * Dual::variable(2, 0));
    EXPECT_NEAR(found.derivative[0], found.value / 2, 1e-12 * found.value);
  }
}

TEST(FadingMemory, RemembersInRealTime) {
  std::array<double, kFadingConstants> constants{};
  std::array<double, kFadingStates> memory{};
  prepare_fading_memory(0.5, 1e-3, constants);

  EXPECT_REALTIME(static_cast<void>(remember(constants.data(), memory.data(), 1.0)));
}

}  // namespace
}  // namespace rths::sim
