// SPDX-License-Identifier: Apache-2.0
#include <rths/loop/closed_loop.hpp>

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/loop/force_feedback.hpp>
#include <rths/loop/perfect_machine.hpp>
#include <rths/sim/alpha_os.hpp>

#include "support/lead_rubber.hpp"

namespace rths::loop {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMass = 1e3, kStiffness = 1e5, kLoad = 1e3;  // [kg], [N/m], [N]

/// A pier whose top is a mass without a stiffness of its own under a constant load, beside a force
/// that is controlled. The specimen is its spring.
class Pier final : public sim::Substructure {
 public:
  explicit Pier(double step)
      : integrator_{one(kMass), one(0), one(kStiffness), step, 0}, step_{step} {}
  [[nodiscard]] std::vector<sim::InterfaceDof> interface() const override {
    return {{"pier.top"}, {"pier.load", AxisKind::Translational, sim::Controlled::Force}};
  }
  void predict(std::span<double> target, std::span<double> rate) noexcept override {
    target[0] = integrator_.predict()[0];
    rate[0] = integrator_.predicted_velocity()[0];
    target[1] = ++begun;
    rate[1] = 0;
  }
  void correct(std::span<const double> force) noexcept override {
    integrator_.correct(VectorXd::Constant(1, force[0]), VectorXd::Constant(1, kLoad));
    controlled = force[1];
    time_ += step_;
  }
  [[nodiscard]] double time() const noexcept override { return time_; }
  [[nodiscard]] double displacement() const { return integrator_.displacement()[0]; }

  int begun = 0;  ///< steps; its force target
  double controlled = 0;

 private:
  static MatrixXd one(double value) { return MatrixXd::Constant(1, 1, value); }
  sim::AlphaOs integrator_;
  double step_, time_ = 0;
};

/// A spring that is at the last command that it has found.
class Spring final : public TransferSystem {
 public:
  void send(std::size_t controller_tick, const Command& command) override {
    EXPECT_EQ(controller_tick, sent.empty() ? controller_tick : last_ + 1);
    last_ = controller_tick;
    sent.push_back(command.displacement[0]);
  }
  void move(std::size_t found, const VectorXd& forces) override {
    ++moves;
    force_target = forces[0];
    displacement_[0] = found == 0 ? 0 : sent.at(found - 1);
    force_ = kStiffness * displacement_;
  }
  void measure(const VectorXd&, const Command&) override {}
  [[nodiscard]] const VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const VectorXd& force() const override { return force_; }

  std::vector<double> sent;
  std::size_t moves = 0;
  double force_target = 0;

 private:
  std::size_t last_ = 0;
  VectorXd displacement_ = VectorXd::Zero(1), force_ = VectorXd::Zero(1);
};

// A mass on a spring under a constant load: u = F/k (1 − cos ωt). The load grows during the first
// step, so it begins in the middle of that.
double expected(double time, double step) {
  return kLoad / kStiffness * (1 - std::cos(std::sqrt(kStiffness / kMass) * (time - step / 2)));
}

ClosedLoopSettings with_path(double step) {
  ClosedLoopSettings settings;
  auto& path = settings.path.emplace().settings;
  path.integration_step = path.simulation_step = step;
  path.substeps = 100;
  settings.host.first_target = 20;
  settings.host.computing = {3};
  return settings;
}

TEST(ClosedLoop, IsTheClosedFormWithATargetPerPeriod) {
  constexpr double kStep = 1e-3;
  Pier pier{kStep};
  Spring spring;
  ClosedLoop loop{pier, spring, {.period = kStep}};

  for (int i = 0; i < 1000; ++i) {
    loop.tick();
    // Of the amplitude: (ω dt)²/8 = 1e-5 of the growing load, and ω³ dt² t/12 < 9e-5 of the
    // trapezoidal rule.
    ASSERT_NEAR(pier.displacement(), expected(pier.time(), kStep), 1e-4 * kLoad / kStiffness) << i;
  }
  EXPECT_EQ(loop.targets(), 1000U);
  EXPECT_EQ(loop.steps(), 1000U);
  EXPECT_EQ(spring.moves, 1000U);
}

TEST(ClosedLoop, StaysNearTheClosedFormAlongThePathOfAPredictorCorrector) {
  constexpr double kStep = 0.01;
  Pier pier{kStep};
  Spring spring;
  ClosedLoop loop{pier, spring, with_path(kStep)};

  while (loop.steps() < 100) {
    const std::size_t steps = loop.steps();
    loop.tick();
    // The machine is a tick behind its command: a damping ratio of −ωτ/2 = −0.5 %, 5 % in 1 s.
    if (loop.steps() > steps) {
      ASSERT_NEAR(pier.displacement(), expected(pier.time(), kStep), 0.1 * kLoad / kStiffness);
    }
  }
  EXPECT_GT(spring.moves, 1000U);
}

TEST(ClosedLoop, AnswersAfterTheTimeOfComputing) {
  Pier pier{0.01};
  Spring spring;
  ClosedLoop loop{pier, spring, with_path(0.01)};
  std::vector<int> arrivals, answers;

  for (int tick = 0; loop.targets() < 5; ++tick) {
    const std::size_t targets = loop.targets(), steps = loop.steps();
    loop.tick();
    if (loop.targets() > targets) arrivals.push_back(tick);
    if (loop.steps() > steps) answers.push_back(tick);
  }

  EXPECT_EQ(arrivals.front(), 20);
  for (std::size_t i = 0; i + 1 < arrivals.size(); ++i) EXPECT_EQ(arrivals[i + 1], answers[i] + 3);
}

TEST(ClosedLoop, SendsForceTargetsWithTheDisplacementsOfTheirStep) {
  for (const bool early : {false, true}) {
    Pier pier{0.01};
    Spring spring;
    auto settings = with_path(0.01);
    settings.targets_act_early = early;
    ClosedLoop loop{pier, spring, settings};

    for (int tick = 0; tick < 20; ++tick) loop.tick();
    EXPECT_EQ(spring.force_target, early ? 1 : 0);
    while (loop.steps() < 1) loop.tick();
    loop.tick();
    EXPECT_EQ(spring.force_target, early ? 2 : 1);
    EXPECT_EQ(pier.controlled, 1);  // a controlled force is its target
  }
}

TEST(ClosedLoop, LeavesAnUntestedDegreeOfFreedomAtRest) {
  Pier pier{1e-3};
  Spring spring;
  ClosedLoop loop{pier, spring, {.period = 1e-3, .tested = {false}}};

  for (int i = 0; i < 100; ++i) loop.tick();

  EXPECT_NE(pier.displacement(), 0);
  for (const double x : spring.sent) EXPECT_EQ(x, 0);
}

TEST(PerfectMachine, MovesItsSpecimenInPieces) {
  const auto bearing = test::plain_lead_rubber();
  const Command command{
      Eigen::Vector2d{0.1, -0.05}, Eigen::Vector2d{1, -0.5}, Eigen::Vector2d::Zero(), {}};
  PerfectMachine at_once{bearing, 0.1}, in_pieces{bearing, 0.1, 10};
  sim::BearingRun whole{bearing, 0.1}, pieces{bearing, 0.01};
  for (auto* machine : {&at_once, &in_pieces}) {
    machine->send(0, command);
    machine->move(1, VectorXd::Zero(1));
    EXPECT_EQ(machine->displacement(), command.displacement);
  }

  EXPECT_EQ(at_once.force(), VectorXd{test::moved(whole, command.displacement)});
  Eigen::Vector2d force;
  for (int k = 1; k <= 10; ++k) force = test::moved(pieces, command.displacement * k / 10);
  EXPECT_LT((in_pieces.force() - force).norm(), 1e-9 * force.norm());
}

TEST(ForceFeedback, IsTheMeasuredForceWithoutCorrections) {
  ForceFeedback feedback{{}, std::nullopt, 1e-3};
  const AxisMeasurement measured{{0.1, 0.2}, {1, 2}, {1e5, 2e5}, 1e6};

  feedback.step(feedback.corrected(measured, true), VectorXd::Zero(2), {});

  EXPECT_EQ(feedback.at_target(), measured.force);
  EXPECT_EQ(feedback.ahead(), measured.force);
}

TEST(ForceFeedback, SubtractsTheForceOfTheMachine) {
  MachineForceCorrection correction;
  correction.machine[0] = {.effective_mass = 1e5, .offset = 2e3};
  ForceFeedback feedback{correction, std::nullopt, 1e-3};

  const auto specimen = feedback.corrected({{0, 0}, {0.1, 0}, {3e4, 5e4}, 1e6}, true);

  EXPECT_EQ(specimen.force, (Eigen::Vector2d{3e4 - 1e4 - 2e3, 5e4}));
}

// The machine is late by two ticks, then the controller by one.
TEST(OrderOf, CountsWhatEachNodeHadDoneBefore) {
  const TickTimes machine{{0.0, 3.4, 3.5, 3.6, 4.0}, {0.1, 3.5, 3.6, 3.7, 4.1}};
  const TickTimes controller{{0.3, 1.3, 2.3, 4.5, 4.6}, {0.4, 1.4, 2.4, 4.6, 4.7}};

  const TickOrder order = order_of(machine, controller);

  EXPECT_EQ(order.machine_before, (std::vector<std::size_t>{1, 1, 1, 5, 5}));
  EXPECT_EQ(order.controller_before, (std::vector<std::size_t>{0, 3, 3, 3, 3}));
}

TEST(OrderOf, IsEmptyIfAllAreOnTime) {
  const TickTimes machine{{0, 1, 2}, {0.1, 1.1, 2.1}};
  const TickTimes controller{{0.3, 1.3, 2.3}, {0.4, 1.4, 2.4}};

  const TickOrder order = order_of(machine, controller);

  EXPECT_TRUE(order.machine_before.empty());
  EXPECT_EQ(order.machine_ticks(7), 8U);
  EXPECT_EQ(order.controller_ticks(7), 7U);
}

TEST(Host, ShiftsATargetIntoTheTicksInWhichItArrived) {
  Host host;
  host.first_target = 7;
  host.computing = {2, 5};
  EXPECT_EQ(host.first_arrival(), 7U);
  EXPECT_EQ(host.arrival(1, 10), 12U);
  EXPECT_EQ(host.arrival(3, 20), 25U);

  host.arrivals = {{3, 4}, {11, 11}, {40, 50}};
  EXPECT_EQ(host.first_arrival(), 4U);
  EXPECT_EQ(host.arrival(1, 10), 11U);
  EXPECT_EQ(host.arrival(1, 30), 31U);  // not before the tick that reached the target
  EXPECT_EQ(host.arrival(2, 20), 40U);
  EXPECT_EQ(host.arrival(3, 20), 25U);
}

}  // namespace
}  // namespace rths::loop
