// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/adapters/numerical.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/lead_rubber.hpp"

namespace rths::adapters {
namespace {

sim::GroundMotion pulse() {
  sim::GroundMotion motion;
  motion.time_step = 0.01;
  for (int i = 0; i < 200; ++i) {
    motion.long_acceleration.push_back(2 * std::sin(0.1 * i));
    motion.lat_acceleration.push_back(std::sin(0.07 * i));
  }
  return motion;
}

NumericalSettings numerical_settings() {
  NumericalSettings s;
  s.structure = std::make_shared<sim::StickModel>(sim::example_plant());
  s.motion = pulse();
  s.bearing_initial_stiffness = test::kInitialStiffness;
  s.duration = 0.5;
  return s;
}

/// A controller and specimen that follow the handshake, one tick at a time.
class Partner {
 public:
  Partner(Adapter& adapter, std::vector<std::string> axes)
      : bench{adapter}, axes_{std::move(axes)} {
    bench.in("daq.atTarget") = 1;
  }

  // One tick: read the flags, answer them, step the solver.
  Status tick() {
    const double flag = bench.out("opf.newTarget");
    if (flag > 0 && previous_ <= 0) {
      bench.in("daq.atTarget") = 0;
      bench.in("daq.switchPC") = 1;
      countdown_ = 3;
      ++targets;
    }
    if (flag <= 0 && previous_ > 0) bench.in("daq.switchPC") = 0;
    previous_ = flag;
    if (countdown_ > 0 && --countdown_ == 0) {
      Eigen::Vector2d u = Eigen::Vector2d::Zero();
      for (const auto& axis : axes_)
        u[axis == "long" ? 0 : 1] = bench.out("opf." + axis + ".displ.target");
      const Eigen::Vector2d force = test::moved(bearing_, u);
      for (const auto& axis : axes_)
        bench.in("daq." + axis + ".force.fbk") = force[axis == "long" ? 0 : 1];
      bench.in("daq.atTarget") = 1;
    }
    time += 0.00025;
    return bench.step(time);
  }

  test::Bench bench;
  int targets = 0;
  double time = 0;

 private:
  std::vector<std::string> axes_;
  sim::BearingRun bearing_{test::plain_lead_rubber(), 0.01};
  double previous_ = 0;
  int countdown_ = 0;
};

TEST(Numerical, RunsTheHandshakeOncePerStep) {
  const auto solver = make_numerical(numerical_settings());
  Partner partner{*solver, {"long", "lat"}};
  Status status = Status::Ok;
  for (int i = 0; i < 5000 && status == Status::Ok; ++i) status = partner.tick();

  EXPECT_EQ(status, Status::Done);
  EXPECT_EQ(partner.targets, 50);  // 0.5 s in steps of 10 ms
  EXPECT_EQ(partner.bench.out("opf.newTarget"), -1);
  EXPECT_EQ(partner.bench.out("step"), 50);
}

TEST(Numerical, GivesTheSameTargetsAsTheAnalysisAlone) {
  const auto solver = make_numerical(numerical_settings());
  Partner partner{*solver, {"long", "lat"}};
  sim::PlantAnalysis alone{sim::assemble(sim::example_plant()), pulse(), test::kInitialStiffness,
                           0.01, -0.05};
  sim::BearingRun bearing{test::plain_lead_rubber(), 0.01};
  for (int step = 0; step < 40; ++step) {
    while (partner.targets <= step) ASSERT_EQ(partner.tick(), Status::Ok);
    const Eigen::Vector2d u = alone.predict();
    EXPECT_EQ(partner.bench.out("opf.long.displ.target"), u[0]);
    EXPECT_EQ(partner.bench.out("opf.lat.displ.target"), u[1]);
    alone.correct(test::moved(bearing, u));
  }
}

TEST(Numerical, PostsNoTargetDuringTheInitialRest) {
  NumericalSettings s = numerical_settings();
  s.rest = 0.3;
  const auto solver = make_numerical(s);
  test::Bench bench{*solver};
  bench.in("daq.atTarget") = 1;

  for (double time = 0; time < 0.3; time += 0.001) {
    ASSERT_EQ(bench.step(time), Status::Ok);
    ASSERT_EQ(bench.out("opf.newTarget"), 0) << time;
  }
  ASSERT_EQ(bench.step(0.301), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), 1);
  EXPECT_EQ(bench.out("opf.1.time.target"), 0.01);
}

TEST(Numerical, StartsWithATargetForAnOlderController) {
  NumericalSettings s = numerical_settings();
  s.handshake = Handshake::TargetFirst;
  const auto solver = make_numerical(s);
  test::Bench bench{*solver};  // atTarget is down

  ASSERT_EQ(bench.step(0.001), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), 1);
  bench.in("daq.switchPC") = 1;
  ASSERT_EQ(bench.step(0.002), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), 0);
  bench.in("daq.switchPC") = 0;
  ASSERT_EQ(bench.step(0.003), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), 0);  // atTarget has not risen yet
  bench.in("daq.atTarget") = 1;
  ASSERT_EQ(bench.step(0.004), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), 1);
}

TEST(Numerical, PostsANumberedTargetInEveryTick) {
  NumericalSettings s = numerical_settings();
  s.handshake = Handshake::Numbered;
  const auto solver = make_numerical(s);
  test::Bench bench{*solver};
  bench.in("daq.atTarget") = 1;  // at rest
  double number = 0, time = 0;
  for (int i = 1; i <= 50; ++i) {
    ASSERT_EQ(bench.step(time += 0.001), Status::Ok);
    ASSERT_EQ(bench.out("opf.newTarget"), i % 2 == 1 ? 2 : 1);
    ASSERT_EQ(bench.out("step"), i - 1);
    number = bench.out("opf.newTarget");
    if (i == 20) {  // the target before does not count
      bench.in("daq.atTarget") = 3 - number;
      ASSERT_EQ(bench.step(time += 0.001), Status::Ok);
      ASSERT_EQ(bench.out("opf.newTarget"), number);
    }
    bench.in("daq.atTarget") = number;
  }
  ASSERT_EQ(bench.step(time += 0.001), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), -1);
}

TEST(Numerical, SaysIfAControllerReturnsNoNumbers) {
  NumericalSettings s = numerical_settings();
  s.handshake = Handshake::Numbered;
  const auto solver = make_numerical(s);
  test::Bench bench{*solver};
  bench.in("daq.atTarget") = 1;
  Status status = Status::Ok;
  for (double time = 0; status == Status::Ok && time < 3; time += 0.001) status = bench.step(time);

  EXPECT_EQ(status, Status::Fault);
  EXPECT_STREQ(bench.message(), "atTarget did not show the target's number before the deadline");
}

TEST(Numerical, WritesATargetOnlyTogetherWithItsFlag) {
  NumericalSettings s = numerical_settings();
  s.computing_time = experiment::ComputingTime{0.003, 0, 0, 0, 1};
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  double displayed = 0;
  for (int i = 0; i < 3000; ++i) {
    const double flag_before = partner.bench.out("opf.newTarget");
    if (partner.tick() != Status::Ok) break;
    const double now = partner.bench.out("opf.long.displ.target");
    if (now != displayed) {
      EXPECT_EQ(flag_before, 0);
      EXPECT_EQ(partner.bench.out("opf.newTarget"), 1);
    }
    displayed = now;
  }
}

TEST(Numerical, TakesTheModelledComputingTimeInVirtualTime) {
  NumericalSettings s = numerical_settings();
  s.computing_time = experiment::ComputingTime{0.003, 0, 0, 0, 1};
  const auto solver = make_numerical(s);
  test::Bench bench{*solver};
  bench.in("daq.atTarget") = 1;

  static_cast<void>(bench.step(0.0100));
  for (double t = 0.01025; t < 0.01299; t += 0.00025) {
    static_cast<void>(bench.step(t));
    EXPECT_EQ(bench.out("opf.newTarget"), 0) << t;
  }
  static_cast<void>(bench.step(0.0131));

  EXPECT_EQ(bench.out("opf.newTarget"), 1);
}

TEST(Numerical, OverrunsWithTheGivenFrequency) {
  NumericalSettings s = numerical_settings();
  s.duration = 5;
  s.computing_time = experiment::ComputingTime{0.003, 0.1, 0.25, 0.006, 9};
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  int overruns = 0;
  int seen = 0;
  while (partner.tick() == Status::Ok) {
    if (partner.targets == seen) continue;
    seen = partner.targets;
    overruns += partner.bench.out("computing_time") > 0.007 ? 1 : 0;
  }

  // 500 draws at one in four: 125, and ±40 is four standard deviations.
  EXPECT_NEAR(overruns, 125, 40);
}

struct Silence {
  const char* name;
  double at_target, switch_pc;
  int ticks_before;
  const char* message;
};

class DeadPartner : public ::testing::TestWithParam<Silence> {};

TEST_P(DeadPartner, EndsTheWaitAtItsDeadlineWithOneClearLine) {
  const auto solver = make_numerical(numerical_settings());
  test::Bench bench{*solver};
  double time = 0;
  bench.in("daq.atTarget") = 1;
  for (int i = 0; i < GetParam().ticks_before; ++i) static_cast<void>(bench.step(time += 0.001));
  bench.in("daq.atTarget") = GetParam().at_target;
  bench.in("daq.switchPC") = GetParam().switch_pc;
  const double begun = time;
  Status status = Status::Ok;
  while (status == Status::Ok && time < 10) status = bench.step(time += 0.001);

  EXPECT_EQ(status, Status::Fault);
  EXPECT_STREQ(bench.message(), GetParam().message);
  EXPECT_NEAR(time - begun, 1.0, 0.01);
}

INSTANTIATE_TEST_SUITE_P(
    Waits, DeadPartner,
    ::testing::Values(Silence{"start", 0, 0, 0, "atTarget did not rise before the deadline"},
                      Silence{"switch", 0, 0, 1, "switchPC did not rise before the deadline"},
                      Silence{"release", 0, 1, 1, "switchPC did not fall before the deadline"}),
    [](const auto& silence) { return std::string{silence.param.name}; });

TEST(Numerical, SignalsTheStopBeforeItFinishes) {
  const auto solver = make_numerical(numerical_settings());
  test::Bench bench{*solver};
  EXPECT_EQ(bench.step(0.001, true), Status::Ok);
  EXPECT_EQ(bench.out("opf.newTarget"), -1);

  EXPECT_EQ(bench.step(0.03, true), Status::Done);
}

TEST(Numerical, PlaysADisplacementHistory) {
  NumericalSettings s = numerical_settings();
  s.duration = 0.05;
  s.history = experiment::DisplacementHistory{0.02, {0, 0.2, 0.4, 0.3}, {0, -0.1, 0, 0}};
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  std::vector<double> targets;
  while (partner.tick() == Status::Ok)
    if (partner.targets > static_cast<int>(targets.size()))
      targets.push_back(partner.bench.out("opf.long.displ.target"));

  const std::vector<double> expected = {0.1, 0.2, 0.3, 0.4, 0.35};
  ASSERT_EQ(targets.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(targets[i], expected[i], 1e-12);
}

TEST(Numerical, SendsTheVerticalForceToTheSpecimen) {
  NumericalSettings s = numerical_settings();
  s.motion.vert_acceleration = s.motion.long_acceleration;
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  sim::PlantAnalysis analysis{*s.structure->matrices(), s.motion, s.bearing_initial_stiffness,
                              s.integration_step, s.alpha};

  for (int target = 1; target <= 20; ++target) {
    while (partner.targets < target) ASSERT_EQ(partner.tick(), Status::Ok);
    analysis.predict();
    EXPECT_NE(analysis.vertical_force(), 0);
    EXPECT_EQ(partner.bench.out("opf.vert.force.target"), analysis.vertical_force()) << target;
  }
}

TEST(Numerical, IntegratesTheMeasuredVerticalForce) {
  NumericalSettings s = numerical_settings();
  s.motion.vert_acceleration = s.motion.long_acceleration;
  s.vertical_feedback = sim::VerticalFeedback::Measured;
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  partner.bench.in("daq.vert.force.fbk") = 1e6;
  sim::PlantAnalysis analysis{*s.structure->matrices(), s.motion, s.bearing_initial_stiffness,
                              s.integration_step,       s.alpha,  sim::VerticalFeedback::Measured};

  for (int target = 1; target <= 2; ++target) {
    while (partner.targets < target) ASSERT_EQ(partner.tick(), Status::Ok);
    analysis.predict();
    EXPECT_EQ(partner.bench.out("opf.vert.force.target"), analysis.vertical_force()) << target;
    analysis.correct(Eigen::Vector2d::Zero(), 1e6);
  }
  EXPECT_NE(analysis.vertical_force(), 0);
}

// Without a vertical component of the motion, overturning alone varies the load.
TEST(Numerical, SendsTheOverturningOfABearingOffTheCentre) {
  NumericalSettings s = numerical_settings();
  sim::IsolatedPlant plant = sim::example_plant();
  plant.bearing_lat = 40;
  s.structure = std::make_shared<sim::StickModel>(plant);
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"long", "lat"}};
  sim::PlantAnalysis analysis{*s.structure->matrices(), s.motion, s.bearing_initial_stiffness,
                              s.integration_step, s.alpha};

  while (partner.targets < 1) ASSERT_EQ(partner.tick(), Status::Ok);
  analysis.predict();
  EXPECT_EQ(partner.bench.out("opf.vert.force.target"), analysis.vertical_force());
  while (partner.targets < 20) ASSERT_EQ(partner.tick(), Status::Ok);
  EXPECT_NE(partner.bench.out("opf.vert.force.target"), 0);
}

TEST(Numerical, RefusesVerticalFeedbackWithoutVerticalMotion) {
  NumericalSettings s = numerical_settings();
  s.vertical_feedback = sim::VerticalFeedback::Measured;

  EXPECT_THROW(static_cast<void>(make_numerical(s)), Error);
}

TEST(Numerical, TestsOneAxisAlone) {
  NumericalSettings s = numerical_settings();
  s.axes = {"lat"};
  const auto solver = make_numerical(s);
  Partner partner{*solver, {"lat"}};
  while (partner.targets < 20) ASSERT_EQ(partner.tick(), Status::Ok);

  EXPECT_NE(partner.bench.out("opf.lat.displ.target"), 0);
  EXPECT_EQ(partner.bench.out("ground.accel.long"), 0);
}

TEST(Numerical, RefusesAnAxisThatItsModelLacks) {
  NumericalSettings s = numerical_settings();
  s.axes = {"vert"};

  EXPECT_EQ(test::error_of([&] { static_cast<void>(make_numerical(s)); }),
            "numerical: axis 'vert' is not in the model, expected long or lat");
}

}  // namespace
}  // namespace rths::adapters
