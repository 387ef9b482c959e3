// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include <rths/controller/safety.hpp>
#include <rths/core/error.hpp>

#include "controller/safety_settings.hpp"
#include "support/files.hpp"
#include "support/period.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

using test::kPeriod;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// A layer in front of a platen that follows its reference after 60 ms, with a spring of 10 MN/m.
class Platen {
 public:
  explicit Platen(const SafetySettings& settings) : safety_{settings} {
    safety_.enable(std::vector<double>(settings.axes.size(), 0.0));
    references_.assign(60, 0.0);
  }
  double step(double command) {
    const SafetyFeedback measured[] = {feedback(references_.front())};
    const double reference = safety_.step({{command}}, measured, true)[0];
    references_.push_back(reference);
    references_.pop_front();
    ++ticks_;
    return reference;
  }
  Safety& safety() { return safety_; }
  [[nodiscard]] SafetyCause cause() const { return safety_.first_trip().cause; }
  [[nodiscard]] SafetyState state() const { return safety_.state(); }

  std::function<SafetyFeedback(double platen)> feedback = [](double platen) {
    return SafetyFeedback{platen, 1e7 * platen};
  };

 private:
  Safety safety_;
  std::deque<double> references_;
  long ticks_ = 0;
};

// 0.1 m at 1 Hz: 0.63 m/s and 3.9 m/s². Begins smoothly.
double motion(long tick) {
  const double t = static_cast<double>(tick) * kPeriod;
  const double share = std::min(1.0, t / 2);
  return 0.1 * share * share * (3 - 2 * share) * std::sin(2 * std::numbers::pi * t);
}

/// Runs a command until the layer is at rest again, at most 20 s.
template <class Command>
long run(Platen& platen, Command command) {
  for (long tick = 0; tick < 20'000; ++tick) {
    platen.step(command(tick));
    if (platen.state() == SafetyState::Off || platen.state() == SafetyState::Tripped) return tick;
  }
  return -1;
}

TEST(Safety, PassesAnAdmissibleCommandUnchanged) {
  Platen platen{settings_of()};

  for (long tick = 0; tick < 10'000; ++tick) ASSERT_EQ(platen.step(motion(tick)), motion(tick));

  EXPECT_EQ(platen.state(), SafetyState::Running);
}

TEST(Safety, HoldsAndRampsToRestAtAStop) {
  Platen platen{settings_of()};
  long tick = 0;
  for (; tick < 3100; ++tick) platen.step(motion(tick));
  const double at_stop = motion(tick - 1), velocity = (motion(tick - 1) - motion(tick - 41)) / 0.04;

  platen.safety().stop();
  double last = at_stop, largest_step = 0, end = 0;
  long ticks = 0;
  for (; platen.state() != SafetyState::Off && ticks < 5000; ++ticks) {
    const double now = platen.step(5.0);  // ignored
    if (platen.state() == SafetyState::Hold) end = now;
    largest_step = std::max(largest_step, std::abs(now - last));
    last = now;
  }

  // Stands v²/2a beyond the place of the stop, and is at rest after hold and ramp of 1.2 s.
  EXPECT_NEAR(end, at_stop + velocity * std::abs(velocity) / 20, 1e-9);
  EXPECT_NEAR(static_cast<double>(ticks), 1201, 25);
  EXPECT_EQ(last, 0);
  EXPECT_LE(largest_step, 0.95 * kPeriod);
  EXPECT_FALSE(platen.safety().has_tripped());
}

// 0.4 m at a limit of 0.1 m/s returns along a bell of 6.3 s instead of 1 s.
TEST(Safety, ComesToRestWithinTheLongestStop) {
  for (const double return_speed : {SafetyLimits::kNone, 0.05}) {
    auto settings = settings_of();
    settings.axes[0].velocity = 0.1;
    settings.axes[0].return_speed = return_speed;
    Platen platen{settings};
    platen.feedback = [](double x) { return SafetyFeedback{x, 1e5 * x}; };
    const auto command = [](long tick) {
      const double share = std::min(1.0, static_cast<double>(tick) * kPeriod / 10);
      return 0.4 * share * share * (3 - 2 * share);
    };
    for (long tick = 0; tick < 10'000; ++tick) platen.step(command(tick));
    ASSERT_EQ(platen.state(), SafetyState::Running);

    platen.safety().stop();
    const long ticks = run(platen, command);

    EXPECT_GT(static_cast<double>(ticks) * kPeriod, 5);
    EXPECT_LT(static_cast<double>(ticks) * kPeriod, longest_stop(settings));
    EXPECT_LT(longest_stop(settings), 50);
  }
}

// A vertical reference leads its platen: standing where the command ended would move the platen on.
TEST(Safety, ReturnsToRestAtAStopWithAReturnSpeed) {
  auto settings = settings_of();
  settings.axes[0].return_speed = 0.8;
  Platen platen{settings};
  long tick = 0;
  for (; tick < 3100; ++tick) platen.step(motion(tick));

  const double at_stop = motion(tick - 1);
  ASSERT_GT(at_stop, 0.03);
  platen.safety().stop();

  for (int k = 1; platen.state() != SafetyState::Off && k < 5000; ++k)
    ASSERT_NEAR(platen.step(5.0), std::max(0.0, at_stop - 0.8 * kPeriod * k), 1e-12) << k;
  EXPECT_FALSE(platen.safety().has_tripped());
}

struct BadCommand {
  const char* name;
  SafetyCause cause;
  double (*command)(long tick);
};

class SafetyCommand : public testing::TestWithParam<BadCommand> {};

TEST_P(SafetyCommand, TripsInTheSamePeriodAndEndsTripped) {
  Platen platen{settings_of()};
  platen.feedback = [](double x) { return SafetyFeedback{x, 1e6 * x}; };

  const long end = run(platen, GetParam().command);

  EXPECT_EQ(platen.cause(), GetParam().cause) << static_cast<int>(platen.cause());
  EXPECT_EQ(platen.state(), SafetyState::Tripped);
  EXPECT_GT(end, 0);
}

double step_of(long tick, double size) { return tick < 100 ? 0 : size; }
double triangle(long tick, double velocity) {
  return tick < 100 ? 0 : velocity * kPeriod * static_cast<double>(tick - 100);
}

INSTANTIATE_TEST_SUITE_P(
    Commands, SafetyCommand,
    testing::Values(
        BadCommand{"NotANumber", SafetyCause::CommandNotFinite,
                   [](long k) { return k < 2600 ? motion(k) : kNan; }},
        BadCommand{"Infinite", SafetyCause::CommandNotFinite,
                   [](long k) { return k < 100 ? 0.0 : std::numeric_limits<double>::infinity(); }},
        BadCommand{"FarAway", SafetyCause::CommandDisplacement,
                   [](long k) { return step_of(k, 0.7); }},
        BadCommand{"Jump", SafetyCause::CommandJump, [](long k) { return step_of(k, 0.04); }},
        BadCommand{"Fast", SafetyCause::CommandVelocity, [](long k) { return 2.0 * motion(k); }},
        BadCommand{"TooNearItsStop", SafetyCause::CommandDisplacement,
                   [](long k) { return triangle(k, 0.8); }}),
    [](const auto& row) { return std::string{row.param.name}; });

// 10 Hz with a growing amplitude: over 40 ms, 38 m/s² is reached before 0.95 m/s.
TEST(Safety, TripsOnAcceleration) {
  auto settings = settings_of();
  settings.axes[0].jerk = SafetyLimits::kNone;
  Platen platen{settings};

  run(platen, [](long k) {
    const double t = static_cast<double>(k) * kPeriod;
    return 0.005 * t * std::sin(20 * std::numbers::pi * t);
  });

  EXPECT_EQ(platen.cause(), SafetyCause::CommandAcceleration) << static_cast<int>(platen.cause());
}

TEST(Safety, TripsOnJerk) {
  auto settings = settings_of();
  settings.axes[0].jerk = 300;
  Platen platen{settings};

  run(platen, [](long t) { return step_of(t, 0.03); });  // 0.03 m / T³ = 469 m/s³

  EXPECT_EQ(platen.cause(), SafetyCause::CommandJerk);
  EXPECT_NEAR(platen.safety().first_trip().value, 0.03 / std::pow(0.04, 3), 1e-6);
}

TEST(Safety, RefusesAFirstCommandFarFromThePlaten) {
  Platen platen{settings_of()};
  platen.feedback = [](double) { return SafetyFeedback{0.02, 0}; };

  EXPECT_EQ(platen.step(0), 0);
  EXPECT_EQ(platen.cause(), SafetyCause::FirstCommand);
  EXPECT_EQ(platen.state(), SafetyState::Tripped);
  EXPECT_EQ(platen.step(0.02), 0) << "a trip is not forgotten";
}

TEST(Safety, WaitsInReadyUntilACommandIsAdmitted) {
  Safety safety{settings_of()};
  const SafetyFeedback feedback[] = {{}};
  safety.enable({{0.0}});

  EXPECT_EQ(safety.step({{0.3}}, feedback, false)[0], 0);
  EXPECT_EQ(safety.state(), SafetyState::Ready);
  EXPECT_EQ(safety.step({{0.001}}, feedback, true)[0], 0.001);
  EXPECT_EQ(safety.state(), SafetyState::Running);
}

TEST(Safety, StopsAllAxesWhenOneTrips) {
  Safety safety{settings_of(2)};
  const SafetyFeedback feedback[] = {{}, {}};
  safety.enable({{0.0, 0.0}});
  for (int i = 0; i < 10; ++i) static_cast<void>(safety.step({{1e-4 * i, 0.0}}, feedback, true));

  const auto references = safety.step({{1e-3, kNan}}, feedback, true);

  EXPECT_EQ(safety.first_trip().axis, 1U);
  // The first axis brakes from its last reference and does not take its new command.
  EXPECT_LT(references[0], 1e-3);
  EXPECT_GE(references[0], 9e-4);
  EXPECT_EQ(references[1], 0);
}

struct BadFeedback {
  const char* name;
  SafetyCause cause;
  long within;  ///< periods after the fault
  /// @param platen  true position   @param tick  since the fault
  SafetyFeedback (*feedback)(double platen, long tick);
  long from = 2600;  ///< [ticks] strong motion
};

class SafetyFeedbackGuard : public testing::TestWithParam<BadFeedback> {};

TEST_P(SafetyFeedbackGuard, Trips) {
  const BadFeedback& bad = GetParam();
  Platen platen{settings_of()};
  long tick = 0;
  platen.feedback = [&](double x) {
    return tick < bad.from ? SafetyFeedback{x, 1e7 * x} : bad.feedback(x, tick - bad.from);
  };

  long tripped = -1;
  for (; tick < 10'000 && tripped < 0; ++tick) {
    platen.step(motion(tick));
    if (platen.safety().has_tripped()) tripped = tick;
  }

  EXPECT_EQ(platen.cause(), bad.cause) << static_cast<int>(platen.cause());
  EXPECT_GE(tripped, bad.from);
  EXPECT_LE(tripped, bad.from + bad.within);
}

SafetyFeedback& held() {
  static SafetyFeedback value;
  return value;
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, SafetyFeedbackGuard,
    testing::Values(BadFeedback{"NotANumber", SafetyCause::FeedbackNotFinite, 0,
                                [](double, long) {
                                  return SafetyFeedback{kNan, 0};
                                }},
                    BadFeedback{"ForceNotANumber", SafetyCause::FeedbackNotFinite, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x, kNan};
                                }},
                    BadFeedback{"FarAway", SafetyCause::FeedbackDisplacement, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x + 0.6, 1e7 * x};
                                },
                                2150},
                    BadFeedback{"Jump", SafetyCause::FeedbackJump, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x + 0.015, 1e7 * x};
                                }},
                    BadFeedback{"Stuck", SafetyCause::FeedbackStuck, 7,
                                [](double x, long k) {
                                  if (k == 0) held() = {x, 0};
                                  return SafetyFeedback{held().displacement, 1e7 * x};
                                }},
                    BadFeedback{"StuckForce", SafetyCause::ForceStuck, 7,
                                [](double x, long k) {
                                  if (k == 0) held() = {0, 1e7 * x};
                                  return SafetyFeedback{x, held().force};
                                }},
                    BadFeedback{"LargeForce", SafetyCause::Force, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x, 5e6};
                                }},
                    BadFeedback{"ForceJump", SafetyCause::ForceJump, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x, 1e7 * x + 1.2e6};
                                }},
                    BadFeedback{"FlippedForceInStrongMotion", SafetyCause::ForceJump, 0,
                                [](double x, long) {
                                  return SafetyFeedback{x, -1e7 * x};
                                },
                                2310},
                    // Without a jump of the force: ½ k x² beyond 20 kJ at x = 63 mm.
                    BadFeedback{"FlippedForceFromTheStart", SafetyCause::ForceSign, 2000,
                                [](double x, long) {
                                  return SafetyFeedback{x, -1e7 * x};
                                },
                                0},
                    // The platen stays behind: 0.63 m/s for 80 ms.
                    BadFeedback{"Lost", SafetyCause::Tracking, 1000,
                                [](double x, long k) {
                                  const double share =
                                      1 - 0.7 * std::min(1.0, static_cast<double>(k) / 300);
                                  return SafetyFeedback{share * x, 1e7 * share * x};
                                }}),
    [](const auto& row) { return std::string{row.param.name}; });

TEST(Safety, RefusesWrongSettings) {
  auto wrong = settings_of();
  wrong.axes[0].braking = 50;
  EXPECT_EQ(test::error_of([&] { Safety{wrong}; }),
            "safety: braking is 50, expected at most the limit of acceleration");
  wrong = settings_of();
  wrong.axes[0].velocity = SafetyLimits::kNone;
  EXPECT_EQ(test::error_of([&] { Safety{wrong}; }),
            "safety: velocity is inf, expected a limit beside those of acceleration and jerk");
  wrong = settings_of();
  wrong.axes[0].return_speed = 1;
  EXPECT_EQ(test::error_of([&] { Safety{wrong}; }),
            "safety: return_speed is 1, expected at most the limit of velocity");
  wrong = settings_of();
  wrong.axes.clear();
  EXPECT_EQ(test::error_of([&] { Safety{wrong}; }), "safety: no axis, expected at least one");
}

TEST(Safety, IsRealTime) {
  Safety safety{settings_of(2)};
  const SafetyFeedback feedback[] = {{}, {}};
  EXPECT_REALTIME(safety.enable({{0.0, 0.0}}));
  long tick = 0;
  EXPECT_REALTIME({
    for (int i = 0; i < 100; ++i, ++tick)
      static_cast<void>(safety.step({{1e-5 * static_cast<double>(tick), 0.0}}, feedback, true));
  });
  EXPECT_REALTIME(safety.stop());
  EXPECT_REALTIME({
    for (int i = 0; i < 2000; ++i) static_cast<void>(safety.step({{kNan, 0.0}}, feedback, true));
  });
  EXPECT_REALTIME(safety.disable());
}

// A fiftieth of the controller's period leaves the machine's own step its time.
TEST(Safety, TakesAFiftiethOfAPeriod) {
#ifdef RTHS_SANITIZED
  GTEST_SKIP() << "SKIPPED: a sanitizer takes most of the time";
#endif
  constexpr int kTicks = 1000;
  constexpr double kLongest = 20e-6;  // [s]
  Safety safety{settings_of(2)};
  safety.enable({{0.0, 0.0}});
  double fastest = 1;
  long tick = 0;
  for (int batch = 0; batch < 20; ++batch) {
    const auto begin = std::chrono::steady_clock::now();
    for (int i = 0; i < kTicks; ++i, ++tick) {
      const double noise = tick % 2 == 0 ? 1e-9 : 0;
      const SafetyFeedback feedback[] = {{motion(tick - 61) + noise, noise}, {noise, noise}};
      static_cast<void>(safety.step({{motion(tick), 0.0}}, feedback, true));
    }
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
    fastest = std::min(fastest, taken.count() / kTicks);
  }
  std::printf("%.2f us per tick of two axes\n", 1e6 * fastest);
  EXPECT_EQ(safety.state(), SafetyState::Running);
  EXPECT_LT(fastest, kLongest);
}

// The page states the table of the code.
TEST(SafetyStates, AreThoseOfThePage) {
  std::ifstream stream{test::source_tree() / "docs" / "safety.md"};
  std::stringstream text;
  text << stream.rdbuf();
  const std::string page = text.str();

  std::size_t rows = 0;
  for (const auto& row : safety_transitions()) {
    const std::string line = std::string{"| "} + to_text(row.from) + " | " + to_text(row.event) +
                             " | " + to_text(row.to) + " |";
    EXPECT_NE(page.find(line), std::string::npos) << line;
    ++rows;
  }
  std::size_t on_page = 0;
  for (int state = 0; state < kSafetyStates; ++state)
    for (int event = 0; event < kSafetyEvents; ++event) {
      const std::string begin = std::string{"\n| "} + to_text(static_cast<SafetyState>(state)) +
                                " | " + to_text(static_cast<SafetyEvent>(event)) + " | ";
      on_page += page.find(begin) == std::string::npos ? 0 : 1;
    }
  EXPECT_EQ(on_page, rows);
}

}  // namespace
}  // namespace rths::controller
