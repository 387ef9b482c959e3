// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <rths/controller/safety.hpp>

#include "controller/safety_settings.hpp"
#include "support/long_run.hpp"
#include "support/period.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Random commands that try to move the reference beyond a limit: noise, jumps, ramps, sines at a
/// limit, invalid values, stops and trips in all phases.
class Fuzzer {
 public:
  explicit Fuzzer(std::uint64_t seed) : random_{seed} { choose(); }
  double command(double last) {
    if (left_-- == 0) choose();
    phase_ += rate_;
    switch (kind_) {
      case 0:
        return last;
      case 1:
        return last + size_ * uniform();
      case 2:
        return last + slope_ * kPeriod;
      case 3:
        return centre_ + size_ * std::sin(phase_);
      case 4:
        return centre_ * (static_cast<long>(phase_) % 2 == 0 ? 1 : -1);
      case 5:
        velocity_ += 60 * kPeriod * uniform();
        return last + velocity_ * kPeriod;
      case 6:  // alternates between two velocities inside the limits
        return last + (static_cast<long>(phase_ * 3) % 2 == 0 ? 0.9 : -0.9) * kPeriod;
      default:
        return bad();
    }
  }
  bool chance(double probability) {
    return std::uniform_real_distribution<>{0, 1}(random_) < probability;
  }

 private:
  double uniform() { return std::uniform_real_distribution<>{-1, 1}(random_); }
  double bad() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    constexpr double kValues[] = {kNotANumber, kInfinity, -kInfinity, 1e300,
                                  -1e300,      5e-324,    0.6,        -0.6};
    return kValues[std::uniform_int_distribution<>{0, 7}(random_)];
  }
  void choose() {
    kind_ = chance(0.002) ? 7 : std::uniform_int_distribution<>{0, 6}(random_);
    left_ = std::uniform_int_distribution<>{1, 150}(random_);
    size_ = std::pow(10, -4 + 3 * std::abs(uniform()));
    slope_ = 1.2 * uniform();
    centre_ = 0.03 * uniform();
    rate_ = 0.3 * std::abs(uniform());
    velocity_ = 0.9 * uniform();
  }
  std::mt19937_64 random_;
  int kind_ = 0, left_ = 0;
  double size_ = 0, slope_ = 0, centre_ = 0, rate_ = 0, phase_ = 0, velocity_ = 0;
};

/// The limits of a reference, restated from its definition.
class Bounds {
 public:
  Bounds(const SafetyLimits& limits, double rest) : limits_{limits}, past_(128, rest) {}
  /// @returns the largest share of a limit that the reference uses
  double add(double reference) {
    past_[++now_ % past_.size()] = reference;
    const auto ago = [&](std::size_t ticks) { return past_[(now_ - ticks) % past_.size()]; };
    constexpr double kWindow = 0.04;
    const double d0 = (ago(0) - ago(40)) / kWindow, d1 = (ago(40) - ago(80)) / kWindow,
                 d2 = (ago(80) - ago(120)) / kWindow;
    const double a0 = (d0 - d1) / kWindow, a1 = (d1 - d2) / kWindow;
    return std::max({std::abs(ago(0)) / limits_.displacement,
                     std::abs(ago(0) - ago(1)) / limits_.jump, std::abs(d0) / limits_.velocity,
                     std::abs(a0) / limits_.acceleration,
                     std::abs(a0 - a1) / kWindow / limits_.jerk});
  }

 private:
  SafetyLimits limits_;
  std::vector<double> past_;
  std::size_t now_ = 1000;
};

struct Fuzzed {
  double worst = 0;            ///< share of a limit
  long trips = 0, passed = 0;  ///< sequences that tripped; periods that passed a command
  std::array<long, 32> causes{};
};

void fuzz(std::uint64_t seed, double return_speed, Fuzzed& found) {
  constexpr long kTicks = 500;
  SafetySettings settings = settings_of();
  settings.axes[0].tracking = SafetyLimits::kNone;  // the guards of feedback have their own tests
  settings.axes[0].feedback_jump = SafetyLimits::kNone;
  settings.axes[0].return_speed = return_speed;
  settings.hold = settings.ramp = 0.01;  // the limits determine the ramp-down
  Safety safety{settings};
  Fuzzer fuzzer{seed};
  Bounds bounds{settings.axes[0], 0};
  safety.enable({{0.0}});
  double last = 0;
  for (long tick = 0; tick < kTicks; ++tick) {
    if (fuzzer.chance(2e-4)) safety.stop();
    if (fuzzer.chance(2e-4)) safety.trip({SafetyCause::NodeSilent, 0, 1, 0.1});
    const double command = tick == 0 ? 0 : fuzzer.command(last);
    const double noise = tick % 2 == 0 ? 1e-9 : 0;
    const SafetyFeedback feedback[] = {{last + noise, noise}};
    const bool has_tripped = safety.has_tripped();
    last = safety.step({{command}}, feedback, true)[0];
    found.passed += safety.state() == SafetyState::Running ? 1 : 0;
    found.worst = std::max(found.worst, bounds.add(last));
    if (!has_tripped && safety.has_tripped()) {
      ++found.trips;
      ++found.causes.at(static_cast<std::size_t>(safety.first_trip().cause));
    }
  }
}

/// Parameter: speed of a stop that returns to rest [m/s], or none.
class SafetyFuzz : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Stops, SafetyFuzz, testing::Values(SafetyLimits::kNone, 0.9));

// Each sequence reaches the end of the ramp-down if it trips early.
// Rounding of the third difference: 8 · 2⁻⁵² · 0.6 m / T³ = 2e-11 m/s³, far below the margin.
TEST_P(SafetyFuzz, NoCommandMovesTheReferenceBeyondALimit) {
  const std::uint64_t sequences = test::is_long() ? 1'000'000 : 10'000;
  Fuzzed found;
  for (std::uint64_t seed = 1; seed <= sequences && found.worst <= 1 + 1e-9; ++seed) {
    fuzz(seed, GetParam(), found);
    ASSERT_LE(found.worst, 1 + 1e-9) << "seed " << seed;
  }
  std::string causes;
  for (std::size_t cause = 0; cause < found.causes.size(); ++cause)
    if (found.causes[cause] > 0)
      causes += "\n  " + std::to_string(found.causes[cause]) + " " +
                to_text(static_cast<SafetyCause>(cause)).quantity;
  std::printf("%lu sequences, %.1f ticks passed on average, %.4f of a limit reached, trips:%s\n",
              sequences, static_cast<double>(found.passed) / static_cast<double>(sequences),
              found.worst, causes.c_str());
  // The fuzzer reaches the limits, so it tests them.
  EXPECT_GT(found.worst, 0.95);
  for (const auto cause :
       {SafetyCause::CommandNotFinite, SafetyCause::CommandDisplacement,
        SafetyCause::CommandVelocity, SafetyCause::CommandAcceleration, SafetyCause::CommandJump})
    EXPECT_GT(found.causes.at(static_cast<std::size_t>(cause)), 0) << static_cast<int>(cause);
}

}  // namespace
}  // namespace rths::controller
