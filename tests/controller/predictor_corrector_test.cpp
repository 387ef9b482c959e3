// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <rths/controller/predictor_corrector.hpp>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

Target target_at(double displacement) {
  return {Eigen::VectorXd::Constant(1, displacement), Eigen::VectorXd::Zero(1),
          Eigen::VectorXd::Zero(1)};
}

PredictorCorrectorSettings settings(int substeps, double slow_down_from) {
  PredictorCorrectorSettings s;
  s.substeps = substeps;
  s.slow_down_from = slow_down_from;
  s.simulation_step = s.integration_step = 0.01;
  return s;
}

struct Expected {
  PcState state;
  double counter, command;
};

// The reference run of the charts: N = 80, D2/D2, slow-down from 0.8 N, targets sin(2π·0.02 n).
TEST(PredictorCorrector, FollowsTheReferenceRun) {
  PredictorCorrector pc{settings(80, 0.8)};
  const std::map<int, int> arrivals = {{0, 1}, {120, 2}, {200, 3}, {280, 4}, {420, 5}};
  const std::map<int, Expected> expected = {{0, {PcState::Correct, 1, .00079312}},
                                            {80, {PcState::Predict, 1, .12769302}},
                                            {120, {PcState::Correct, 41, .23573598}},
                                            {160, {PcState::Predict, 1, .25021934}},
                                            {200, {PcState::Correct, 41, .31110731}},
                                            {240, {PcState::Predict, 1, .36959267}},
                                            {280, {PcState::Correct, 41, .42777913}},
                                            {320, {PcState::Predict, 1, .48313730}},
                                            {384, {PcState::AutoSlowDown, 65, .56980255}},
                                            {400, {PcState::AutoSlowDown, 71.173530, .57796591}},
                                            {419, {PcState::AutoSlowDown, 71.934630, .57896993}},
                                            {420, {PcState::Correct, 71.943968, .57898028}},
                                            {450, {PcState::Correct, 74.737982, .58206113}},
                                            {460, {PcState::Predict, 1, .58906257}}};
  Target target = target_at(0);
  pc.substep(false, target);  // at rest, before the first target

  for (int substep = 0; substep <= 460; ++substep) {
    const auto arrival = arrivals.find(substep);
    if (arrival != arrivals.end())
      target = target_at(std::sin(2 * std::numbers::pi * 0.02 * arrival->second));
    pc.substep(arrival != arrivals.end(), target);
    const auto row = expected.find(substep);
    if (row == expected.end()) continue;
    EXPECT_EQ(pc.state(), row->second.state) << substep;
    EXPECT_NEAR(pc.counter(), row->second.counter, 1e-6) << substep;
    EXPECT_NEAR(pc.command()[0], row->second.command, 1e-6) << substep;
  }
}

// Targets that come in time: the command passes through each of them at the end of its step.
TEST(PredictorCorrector, ReachesEveryTargetThatComesInTime) {
  for (const double slow_down_from : {0.6, 0.8}) {
    PredictorCorrector pc{settings(100, slow_down_from)};
    Target target = target_at(0);
    for (int step = 1; step <= 20; ++step) {
      target = target_at(std::sin(0.3 * step));
      // Three tenths of the step are prediction, as with a solver that takes 3 ms of 10.
      for (int substep = 0; substep < 70 + (step == 1 ? 30 : 0); ++substep)
        pc.substep(substep == 0, target);
      EXPECT_NEAR(pc.command()[0], std::sin(0.3 * step), 1e-12);
      for (int substep = 0; substep < 30; ++substep) pc.substep(false, target);
      EXPECT_EQ(pc.state(), PcState::Predict);
    }
  }
}

TEST(PredictorCorrector, MovesContinuouslyThroughEverySwitch) {
  PredictorCorrector pc{settings(100, 0.6)};
  Target target = target_at(0);
  pc.substep(false, target);
  double previous = 0;
  // Bound on the polynomials' speed: a target of 0.3 rad/step on unit amplitude, ×2 for overshoot.
  const double largest_move = 2 * 0.3 / 100;
  int next = 0;
  for (int substep = 0; substep < 5000; ++substep) {
    const bool arrives = substep == next;
    if (arrives) {
      const int step = substep / 100 + 1;
      target = target_at(std::sin(0.1 * step));
      next += step % 5 == 0 ? 160 : 100;  // every fifth target is late
    }
    pc.substep(arrives, target);
    EXPECT_LE(std::abs(pc.command()[0] - previous), largest_move) << substep;
    previous = pc.command()[0];
  }
}

TEST(PredictorCorrector, FreezesAtTheHoldPointWhenTheTargetNeverArrives) {
  for (const double slow_down_from : {0.6, 0.8}) {
    PredictorCorrector pc{settings(100, slow_down_from)};
    pc.substep(false, target_at(0));
    for (int substep = 0; substep < 3000; ++substep) pc.substep(substep == 0, target_at(1));
    const double before = pc.command()[0];

    pc.substep(false, target_at(1));

    EXPECT_EQ(pc.state(), PcState::AutoSlowDown);
    EXPECT_NEAR(pc.counter(), 100 * (1 + slow_down_from) / 2, 1e-6);
    EXPECT_NEAR(pc.command()[0], before, 1e-9);
    EXPECT_GT(before, 1.5);  // it overshot the target
    // It waits since the hold point, but its rates are those of its path.
    EXPECT_GT(std::abs(pc.command_velocity()[0]), 1);
    const double period = 0.01 / 100;
    const double held = (3000 - 100 - pc.counter()) * period;
    EXPECT_NEAR(pc.lost_time(), held, 2 * period);
  }
}

TEST(PredictorCorrector, HoldsWhereItIsTold) {
  auto s = settings(100, 0.4);
  s.hold_at = 0.5;
  PredictorCorrector pc{s};
  pc.substep(false, target_at(0));
  for (int substep = 0; substep < 3000; ++substep) pc.substep(substep == 0, target_at(1));

  EXPECT_NEAR(pc.counter(), 50, 1e-6);
  s.hold_at = 0.4;
  EXPECT_THROW(PredictorCorrector{s}, Error);
}

// In steady motion: the command waits for three substeps, then goes on where it was.
TEST(PredictorCorrector, WaitsWithoutLeavingItsPath) {
  const auto s = settings(100, 0.6);
  PredictorCorrector pc{s}, waiting{s};
  for (int substep = 0; substep < 250; ++substep) {
    const bool arrives = substep % 100 == 1;
    pc.substep(arrives, target_at(1));
    waiting.substep(arrives, target_at(1));
  }
  const double before = waiting.command()[0];

  for (int i = 0; i < 3; ++i) waiting.wait();

  EXPECT_EQ(waiting.command()[0], before);
  EXPECT_NEAR(waiting.lost_time(), 3 * s.simulation_step / s.substeps, 1e-12);
  pc.substep(false, target_at(1));
  waiting.substep(false, target_at(1));
  EXPECT_EQ(waiting.command()[0], pc.command()[0]);
}

// Compares the velocity with differences of the command over the time of its path, through
// predictions, corrections, slow-downs and recoveries.
TEST(PredictorCorrector, GivesTheVelocityAlongItsPathInEveryState) {
  auto s = settings(1000, 0.6);
  PredictorCorrector pc{s};
  pc.substep(false, target_at(0));
  const double period = s.simulation_step / s.substeps;
  std::vector<double> command;
  std::vector<double> velocity, path;
  std::vector<bool> ends_a_branch;
  std::map<PcState, int> seen;
  int next = 0;
  int step = 0;
  for (int substep = 0; substep < 20'000; ++substep) {
    const bool arrives = substep == next;
    if (arrives) next += ++step % 4 == 0 ? 2000 : 1000;  // every fourth solution is a step late
    pc.substep(arrives, target_at(std::sin(0.2 * step)));
    command.push_back(pc.command()[0]);
    velocity.push_back(pc.command_velocity()[0]);
    path.push_back(substep * period - pc.lost_time());
    // The last substep of a step may be cut short, so that the counter ends at N.
    ends_a_branch.push_back(arrives || pc.counter() <= 1 || pc.counter() >= s.substeps);
    ++seen[pc.state()];
  }

  ASSERT_EQ(seen.size(), 3U);
  // Central differences of a motion of 20 m/s, over a path whose pace changes by 1/200 a substep.
  int compared = 0;
  for (std::size_t i = 1; i + 1 < command.size(); ++i) {
    if (ends_a_branch[i - 1] || ends_a_branch[i] || ends_a_branch[i + 1]) continue;
    const double way = path[i + 1] - path[i - 1];
    if (way < 0.01 * period) continue;  // it stands
    const double difference = (command[i + 1] - command[i - 1]) / way;
    EXPECT_NEAR(velocity[i], difference, 20.0 / 200) << i;
    ++compared;
  }
  EXPECT_GT(compared, 19'000);
}

// From rest the increment stays at its floor of 0.001 until (i − i_SD)/(0.1 N) is larger, 0.1 N
// substeps; then it grows by 1 + 10/N each, a thousandfold until full speed, where the step ends.
TEST(PredictorCorrector, RecoversFromALongHoldInTheTimeTheFloorAllows) {
  PredictorCorrector pc{settings(80, 0.8)};
  pc.substep(false, target_at(0));
  const Target first = target_at(1);
  for (int substep = 0; substep < 5000; ++substep) pc.substep(substep == 0, first);
  int needed = 0;
  const Target second = target_at(1.1);
  for (pc.substep(true, second); pc.counter() < 80; pc.substep(false, second)) ++needed;

  const double expected = 0.1 * 80 + std::log(1000.0) / std::log(1 + 10.0 / 80);
  EXPECT_NEAR(needed, expected, 1.5);
}

TEST(PredictorCorrector, DoesNotSlowDownForATargetJustInTime) {
  PredictorCorrector pc{settings(100, 0.6)};
  Target target = target_at(0.1);
  for (int substep = 0; substep < 100; ++substep) pc.substep(substep == 0, target);
  for (int substep = 0; substep < 60; ++substep) pc.substep(false, target);
  EXPECT_EQ(pc.state(), PcState::Predict);
  EXPECT_EQ(pc.counter(), 60);

  target = target_at(0.2);
  pc.substep(true, target);

  EXPECT_EQ(pc.state(), PcState::Correct);
  EXPECT_EQ(pc.counter(), 61);
}

TEST(PredictorCorrector, RestartsTheStepWhenATargetArrivesWhileItCorrects) {
  PredictorCorrector pc{settings(100, 0.6)};
  for (int substep = 0; substep < 40; ++substep) pc.substep(substep == 0, target_at(1));
  const double before = pc.command()[0];

  pc.substep(true, target_at(2));

  EXPECT_EQ(pc.counter(), 1);
  EXPECT_NEAR(pc.command()[0], before, 0.02);
}

TEST(PredictorCorrector, StartsFromTheInitialSetpoint) {
  PredictorCorrector pc{settings(100, 0.6)};

  for (int substep = 0; substep < 50; ++substep) pc.substep(false, target_at(0.25));

  EXPECT_EQ(pc.state(), PcState::Initialize);
  EXPECT_EQ(pc.counter(), 100);
  EXPECT_EQ(pc.command()[0], 0.25);
}

TEST(PredictorCorrector, IgnoresTargetWordsThatChangeBeforeTheirFlag) {
  PredictorCorrector pc{settings(100, 0.6)};
  pc.substep(false, target_at(0));

  pc.substep(false, target_at(5));

  EXPECT_EQ(pc.command()[0], 0);
}

TEST(PredictorCorrector, CapsXiWhereACorrectorWouldGrowWithoutBound) {
  auto s = settings(1000, 0.95);
  s.largest_xi = 0.9;
  PredictorCorrector pc{s};
  for (int substep = 0; substep < 20'000; ++substep) pc.substep(substep == 0, target_at(1));
  const double before = pc.command()[0];
  ASSERT_GT(pc.counter(), 970);  // it froze at 0.975, beyond the cap

  pc.substep(true, target_at(1.5));

  EXPECT_NEAR(pc.counter(), 900, 1.0);
  EXPECT_NEAR(pc.command()[0], before, 0.01);
}

// Differences of the history are exact for motion up to fourth order, and one step apart.
TEST(PredictorCorrector, DifferencesTheTargetHistoryForVelocityFamilies) {
  auto s = settings(100, 0.6);
  s.predictor = Polynomial::DV;
  s.corrector = Polynomial::DV;
  PredictorCorrector pc{s};
  const auto motion = [](double step) { return 0.01 * step * step; };
  for (int step = 1; step <= 12; ++step)
    for (int substep = 0; substep < 100; ++substep)
      pc.substep(substep == 0, target_at(motion(step)));

  for (int substep = 1; substep <= 50; ++substep) {
    pc.substep(false, target_at(motion(12)));
    EXPECT_NEAR(pc.command()[0], motion(12 + substep / 100.0), 1e-9);
  }
}

TEST(PredictorCorrector, UsesTheRatesThatTargetsCarry) {
  auto s = settings(100, 0.6);
  s.predictor = Polynomial::DVA;
  s.corrector = Polynomial::DVA;
  s.targets_carry_rates = true;
  PredictorCorrector pc{s};
  Target target = target_at(1);
  target.velocity[0] = 3;
  target.acceleration[0] = -20;
  for (int substep = 0; substep < 100; ++substep) pc.substep(substep == 0, target);

  for (int substep = 1; substep <= 30; ++substep) {
    pc.substep(false, target);
    const double t = substep * 1e-4;
    EXPECT_NEAR(pc.command()[0], 1 + 3 * t - 10 * t * t, 1e-12);
    EXPECT_NEAR(pc.command_velocity()[0], 3 - 20 * t, 1e-9);
    EXPECT_NEAR(pc.command_acceleration()[0], -20, 1e-7);
  }
}

// Slow testing: a step takes ten times longer in wall time, so velocities are a tenth.
TEST(PredictorCorrector, ScalesRatesToWallTime) {
  auto s = settings(1000, 0.6);
  s.simulation_step = 0.1;
  PredictorCorrector pc{s};
  for (int step = 1; step <= 5; ++step)
    for (int substep = 0; substep < 1000; ++substep)
      pc.substep(substep == 0, target_at(0.01 * step));

  EXPECT_NEAR(pc.command_velocity()[0], 0.01 / 0.1, 1e-9);
}

TEST(PredictorCorrector, MovesAxesIndependently) {
  auto s = settings(100, 0.6);
  s.axes = 2;
  PredictorCorrector pc{s};
  const Target rest{Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  const Target target{Eigen::Vector2d{1, -2}, Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  PredictorCorrector along{settings(100, 0.6)};  // the first axis alone
  pc.substep(false, rest);
  along.substep(false, target_at(0));

  for (int substep = 0; substep < 100; ++substep) {
    pc.substep(substep == 0, target);
    along.substep(substep == 0, target_at(1));
    EXPECT_EQ(pc.command()[0], along.command()[0]);
    EXPECT_EQ(pc.command()[1], -2 * along.command()[0]);
  }
  EXPECT_NEAR(pc.command()[0], 1, 1e-12);
}

TEST(PredictorCorrector, IsAtEachTargetAtOnceWithOneSubstep) {
  PredictorCorrector pc{settings(1, 0.4)};
  pc.substep(false, target_at(0));
  for (int i = 1; i <= 50; ++i) {
    const double target = std::sin(0.1 * i);
    pc.substep(true, target_at(target));
    EXPECT_NEAR(pc.command()[0], target, 1e-15);
    EXPECT_EQ(pc.counter(), 1);
  }
  EXPECT_EQ(pc.lost_time(), 0);
}

TEST(PredictorCorrector, HoldsAndStartsAtOnceWithOneSubstep) {
  auto one = settings(1, 0.4);
  one.hold_at = 0.5;
  one.predictor = one.corrector = Polynomial::D3;
  PredictorCorrector pc{one};
  pc.substep(false, target_at(0));
  for (int i = 1; i <= 10; ++i) pc.substep(true, target_at(0.1 * i));

  for (const double lost : {0.005, 0.015, 0.025}) {  // half a step further, then on hold
    pc.substep(false, target_at(1));
    EXPECT_NEAR(pc.command()[0], 1.05, 1e-12);
    EXPECT_NEAR(pc.lost_time(), lost, 1e-15);
  }
  pc.substep(true, target_at(1.1));

  EXPECT_NEAR(pc.command()[0], 1.1, 1e-15);
  EXPECT_NEAR(pc.lost_time(), 0.03, 1e-15);  // three steps late
}

TEST(PredictorCorrector, HoldsWithinAFewSubsteps) {
  for (int substeps = 1; substeps <= 12; ++substeps) {
    auto few = settings(substeps, 0.4);
    few.hold_at = 0.5;
    PredictorCorrector pc{few};
    for (int i = 0; i < 6 * substeps; ++i) pc.substep(i == 0, target_at(0.1));

    EXPECT_NEAR(pc.counter(), 0.5 * substeps, 0.01) << substeps;
    pc.substep(true, target_at(0.2));
    for (int i = 0; i < 20 * substeps && pc.state() == PcState::Correct; ++i)
      pc.substep(false, target_at(0.2));
    EXPECT_EQ(pc.state(), PcState::Predict) << substeps;
  }
}

TEST(PredictorCorrector, RefusesSettingsThatCannotWork) {
  auto no_substeps = settings(0, 0.6);
  auto no_axes = settings(100, 0.6);
  no_axes.axes = 0;
  auto xi_of_one = settings(100, 0.6);
  xi_of_one.largest_xi = 1;

  EXPECT_NE(test::error_of([&] { PredictorCorrector{no_substeps}; }), "");
  EXPECT_NE(test::error_of([&] { PredictorCorrector{no_axes}; }), "");
  EXPECT_NE(test::error_of([&] { PredictorCorrector{xi_of_one}; }), "");
}

TEST(PredictorCorrector, StepsInRealTimeInEveryState) {
  PredictorCorrector pc{settings(100, 0.6)};
  const Target target = target_at(0.1);
  for (int substep = 0; substep < 300; ++substep) {
    const bool arrives = substep == 5 || substep == 205;
    EXPECT_REALTIME(pc.substep(arrives, target));
  }
}

TEST(SamplingDelay, IsWarnedAboveSixTenthsAndRefusedFromEight) {
  for (const double slow_down_from : {0.6, 0.8}) {
    const auto s = settings(100, slow_down_from);
    EXPECT_EQ(judge_delay(0, s), DelayRating::Fine);
    EXPECT_EQ(judge_delay(60, s), DelayRating::Fine);
    EXPECT_EQ(judge_delay(61, s), DelayRating::Warned);
    EXPECT_EQ(judge_delay(79, s), DelayRating::Warned);
    EXPECT_EQ(judge_delay(80, s), DelayRating::Refused);
  }
}

// A command held at 0.65 of the step never reaches 0.66.
TEST(SamplingDelay, IsRefusedFromTheHoldPointOn) {
  EXPECT_EQ(judge_delay(64, settings(100, 0.3)), DelayRating::Warned);
  EXPECT_EQ(judge_delay(66, settings(100, 0.3)), DelayRating::Refused);
}

}  // namespace
}  // namespace rths::controller
