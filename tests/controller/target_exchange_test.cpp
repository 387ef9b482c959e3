// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/controller/target_exchange.hpp>

#include "support/files.hpp"
#include "support/realtime_guard.hpp"

namespace rths::controller {
namespace {

constexpr double kIdle = 0, kNew = 1, kStop = -1;

PredictorCorrectorSettings make_settings() {
  PredictorCorrectorSettings settings;
  settings.substeps = 100;
  return settings;
}

/// A predictor-corrector with its handshake, driven by the test.
class Controller {
 public:
  explicit Controller(int delay_substeps = 0)
      : command{make_settings()}, exchange{{delay_substeps}, make_settings()} {}

  void substep(double new_target_word, double measured = 0) {
    const bool flag = exchange.begin(new_target_word);
    command.substep(flag, target);
    exchange.end(command, Eigen::VectorXd::Constant(1, measured),
                 Eigen::VectorXd::Constant(1, 1000 * measured));
  }
  void substeps(int count, double word, double measured = 0) {
    for (int i = 0; i < count; ++i) substep(word, measured);
  }

  PredictorCorrector command;
  TargetExchange exchange;
  Target target{Eigen::VectorXd::Constant(1, 0.1), Eigen::VectorXd::Zero(1),
                Eigen::VectorXd::Zero(1)};
};

TEST(TargetExchange, IsAtTargetWithLiveFeedbackWhileIdle) {
  Controller controller;

  controller.substep(kIdle, 0.5);
  controller.substep(kIdle, 0.7);

  EXPECT_TRUE(controller.exchange.at_target());
  EXPECT_EQ(controller.exchange.held_displacement()[0], 0.7);
}

TEST(TargetExchange, LowersAtTargetNoLaterThanItRaisesSwitchPc) {
  Controller controller;
  controller.substep(kIdle);

  controller.substep(kNew);

  EXPECT_TRUE(controller.exchange.switch_pc());
  EXPECT_FALSE(controller.exchange.at_target());
}

TEST(TargetExchange, HoldsTheFlagForOneSubstepOnly) {
  Controller controller;
  controller.substep(kIdle);
  controller.substep(kNew);
  const double after_first = controller.command.counter();

  controller.substep(kNew);

  EXPECT_GT(controller.command.counter(), after_first);
}

TEST(TargetExchange, LowersSwitchPcWhenNewTargetFalls) {
  Controller controller;
  controller.substeps(5, kNew);
  EXPECT_TRUE(controller.exchange.switch_pc());

  controller.substep(kIdle);

  EXPECT_FALSE(controller.exchange.switch_pc());
}

TEST(TargetExchange, SamplesTheFeedbackInTheSubstepInWhichTheTargetIsReached) {
  Controller controller;
  controller.substeps(99, kNew, 0.2);
  EXPECT_FALSE(controller.exchange.at_target());

  controller.substep(kNew, 0.3);
  controller.substeps(20, kIdle, 0.4);

  EXPECT_TRUE(controller.exchange.at_target());
  EXPECT_EQ(controller.exchange.held_displacement()[0], 0.3);
  EXPECT_EQ(controller.exchange.held_force()[0], 300);
}

TEST(TargetExchange, WaitsForTheSpecimenWhenTheSampleIsDelayed) {
  Controller controller{30};
  controller.substeps(100, kNew, 0.2);
  EXPECT_FALSE(controller.exchange.at_target());

  controller.substeps(29, kIdle, 0.3);
  EXPECT_FALSE(controller.exchange.at_target());
  controller.substep(kIdle, 0.4);

  EXPECT_TRUE(controller.exchange.at_target());
  EXPECT_EQ(controller.exchange.held_displacement()[0], 0.4);
}

// The first correction already passes the delay's count; this must not count as arrival.
TEST(TargetExchange, DoesNotMistakeTheFirstCorrectionForADelayedArrival) {
  Controller controller{30};

  controller.substeps(60, kNew);

  EXPECT_FALSE(controller.exchange.at_target());
}

// After a slow-down the counter is fractional, so a test for equality would never hold.
TEST(TargetExchange, SamplesInTheSlowDownWhereTheCounterIsFractional) {
  Controller controller{75};

  controller.substeps(100, kNew);
  controller.substeps(400, kIdle, 0.5);

  EXPECT_EQ(controller.command.state(), PcState::AutoSlowDown);
  EXPECT_TRUE(controller.exchange.at_target());
}

TEST(TargetExchange, StopsTenSubstepsAfterNewTargetGoesNegative) {
  Controller controller;
  controller.substeps(9, kStop);
  EXPECT_FALSE(controller.exchange.stopped());

  controller.substep(kStop);

  EXPECT_TRUE(controller.exchange.stopped());
}

TEST(TargetExchange, RefusesADelayThatLeavesTheIntegratorNoTime) {
  EXPECT_NE(test::error_of([] { TargetExchange({80}, make_settings()); }), "");
  EXPECT_EQ(test::error_of([] { TargetExchange({79}, make_settings()); }), "");
  EXPECT_NE(test::error_of([] { TargetExchange({-1}, make_settings()); }), "");
}

TEST(TargetExchange, WorksInRealTime) {
  Controller controller;
  const Eigen::VectorXd displacement = Eigen::VectorXd::Zero(1);
  const Eigen::VectorXd force = Eigen::VectorXd::Zero(1);
  for (int substep = 0; substep < 150; ++substep) {
    bool flag = false;
    EXPECT_REALTIME(flag = controller.exchange.begin(substep < 3 ? kNew : kIdle));
    controller.command.substep(flag, controller.target);
    EXPECT_REALTIME(controller.exchange.end(controller.command, displacement, force));
  }
}

TEST(TargetExchange, TellsAdjacentTargetsApartByTheirNumbers) {
  Controller controller;
  EXPECT_EQ(controller.exchange.number(), 1);
  for (const double number : {2.0, 1.0, 2.0, 1.0}) {
    controller.substep(number);

    EXPECT_TRUE(controller.exchange.switch_pc());
    EXPECT_FALSE(controller.exchange.at_target());
    controller.substeps(99, number, 0.3);
    EXPECT_TRUE(controller.exchange.at_target());
    EXPECT_EQ(controller.exchange.number(), number);
    EXPECT_EQ(controller.exchange.held_displacement()[0], 0.3);
  }
}

}  // namespace
}  // namespace rths::controller
