// SPDX-License-Identifier: Apache-2.0
#include "hybrid_loop.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/ats.hpp>
#include <rths/core/axis.hpp>
#include <rths/experiment/block_settings.hpp>
#include <rths/loop/closed_loop.hpp>
#include <rths/loop/perfect_machine.hpp>
#include <rths/sim/plant_analysis.hpp>

namespace rths::bench {
namespace {

using Eigen::VectorXd;
using sim::machine::PlatenFeedback;
using sim::machine::PlatenReference;
using sim::machine::PlatenRun;

constexpr int kSubsteps = 10;              // of the predictor-corrector in a period
constexpr double kIntegrationStep = 0.01;  // [s]
constexpr double kAlpha = -0.05;           // of α-OS
constexpr int kIntegrationSubsteps = 10;   // between targets
constexpr int kComputingTicks = 3;         // of the solver: the paper's mean
constexpr int kRestTicks = 1000;           // before the first target
constexpr int kSpecimenSteps = 10;         // per integration step, in the numerical loop
constexpr double kPaperFeedForward = 0.4;  // set: see docs/theory/platen_machine.md

class Bare final : public Compensator {
 public:
  double step(const AxisCommand& command, double /*measured*/, double /*force*/) override {
    return command[0];
  }
};

class PaperAts final : public Compensator {
 public:
  double step(const AxisCommand& command, double measured, double /*force*/) override {
    return ats_.step(command, measured, 1, true);
  }
  [[nodiscard]] Eigen::Vector3d coefficients() const override { return ats_.coefficients(); }

 private:
  controller::Ats ats_{controller::AtsSettings{}};
};

class Inverse final : public Compensator {
 public:
  explicit Inverse(const controller::AdaptiveInverseSettings& settings) : inverse_{settings} {}
  double step(const AxisCommand& command, double measured, double force) override {
    return inverse_.step(command[0], measured, force, 1, true);
  }
  [[nodiscard]] Eigen::Vector3d coefficients() const override {
    const auto c = inverse_.coefficients();
    return {c.a0, c.a1, c.a2};
  }

 private:
  controller::AdaptiveInverse inverse_;
};

/// The machine with a controller's compensators and force correction.
class PlatenTransfer final : public loop::TransferSystem {
 public:
  PlatenTransfer(const PlatenTest& test, const Controller& controller)
      : test_{test},
        controller_{controller},
        machine_{test.at_rest},
        force_feedback_{controller.force.correction, controller.force.target_force, kPeriod} {
    for (std::size_t i = 0; i < 2; ++i) axes_[i] = controller.compensator(i);
  }

  void send(std::size_t /*controller_tick*/, const loop::Command& command) override {
    reference_.feed_forward = controller_.feed_forward;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const double x = command.displacement[i], measured = feedback_.displacement[i];
      reference_.displacement[i] = axes_[axis]->step(
          {x, command.velocity[i], command.acceleration[i]}, measured, force_feedback_.ahead()[i]);
      history[axis].command.push_back(x);
      history[axis].measured.push_back(measured);
      history[axis].coefficients.push_back(axes_[axis]->coefficients());
    }
    if (records_commands) commands.push_back(command);
  }

  void move(std::size_t /*found*/, const VectorXd& forces) override {
    reference_.axial_load = test_.machine.specimen.axial_load + forces[0];
    if (machine_.step(reference_, feedback_) != Status::Ok) ++limits;
    displacement_ = feedback_.displacement.head<2>();
  }

  void measure(const VectorXd& target, const loop::Command& last) override {
    loop::AxisMeasurement measured{displacement_, feedback_.acceleration.head<2>(),
                                   feedback_.force.head<2>(), feedback_.force[2]};
    if (!controller_.force.knows_offset) measured.force -= test_.machine.transducers.force_offset;
    force_feedback_.step(force_feedback_.corrected(measured, true), target, last);
    force_ = force_feedback_.at_target();
  }

  [[nodiscard]] const VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const VectorXd& force() const override { return force_; }

  std::array<AxisHistory, 2> history;
  std::vector<loop::Command> commands;
  bool records_commands = false;
  long limits = 0;  ///< periods with a limit of the machine reached

 private:
  const PlatenTest& test_;
  const Controller& controller_;
  PlatenRun machine_;
  std::array<std::unique_ptr<Compensator>, 2> axes_;
  loop::ForceFeedback force_feedback_;
  PlatenReference reference_;
  PlatenFeedback feedback_;
  VectorXd displacement_ = VectorXd::Zero(2), force_ = VectorXd::Zero(2);
};

controller::PredictorCorrectorSettings command_settings() {
  controller::PredictorCorrectorSettings settings;
  settings.axes = 2;
  settings.integration_step = settings.simulation_step = kIntegrationStep;
  settings.substeps = static_cast<int>(std::lround(kIntegrationStep / kPeriod)) * kSubsteps;
  return settings;
}

sim::PlantAnalysis analysis_of(const PlatenTest& test) {
  return {test.plant,          test.motion, sim::initial_stiffness(test.machine.specimen),
          kIntegrationStep,    kAlpha,      sim::VerticalFeedback::Model,
          kIntegrationSubsteps};
}

// The solver computes as long as the paper's at the mean.
loop::ClosedLoopSettings loop_settings(const PlatenTest& test) {
  loop::ClosedLoopSettings settings;
  settings.period = kPeriod;
  settings.tested.assign(test.axes.begin(), test.axes.end());
  settings.path.emplace().settings = command_settings();
  settings.host.computing = {kComputingTicks};
  settings.host.first_target = kRestTicks;
  return settings;
}

void note(const sim::PlantAnalysis& analysis, loop::FloorMonitor& floors,
          loop::ResponseHistory& response) {
  response.append_displacement(analysis.base_displacement());
  floors.append(analysis, response);
}

long steps_of(const PlatenTest& test) { return std::lround(test.duration / kIntegrationStep); }

}  // namespace

Controller bare_controller() {
  return {"none", 0, {}, [](std::size_t) { return std::make_unique<Bare>(); }};
}

Controller paper_controller() {
  const auto setup = controller::unison_eqs_setup();
  return {"paper",
          kPaperFeedForward,
          {loop::MachineForceCorrection{{setup.long_axis, setup.lat_axis}}, std::nullopt},
          [](std::size_t) { return std::make_unique<PaperAts>(); }};
}

Controller inverse_controller(const sim::machine::PlatenMachine& nominal,
                              const sim::Bearing& bearing, const Config& constants) {
  const auto axes = names_of(kHorizontal);
  const auto observer =
      experiment::table_force_observer_settings(constants.table("observer"), axes, kPeriod);
  auto inverse = experiment::adaptive_inverse_settings(constants.table("inverse"), axes, kPeriod);
  for (std::size_t axis = 0; axis < inverse.size(); ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    inverse[axis].force_capacity = nominal.limits.force[i];
    inverse[axis].effective_mass = nominal.mass[i];
    inverse[axis].largest_reference = nominal.limits.stroke[i];
  }
  auto target_force = experiment::target_force_settings(constants.table("target_force"), axes,
                                                        kPeriod, kIntegrationStep, &bearing);
  return {
      "inverse",
      0,
      {loop::TableForceCorrection{{observer.machine[0], observer.machine[1]}, observer.observer},
       std::move(target_force), true},
      [inverse](std::size_t axis) { return std::make_unique<Inverse>(inverse[axis]); }};
}

HybridHistory run_hybrid(const PlatenTest& test, const Controller& controller) {
  HybridHistory history;
  history.response = {test.plant.floor_names, kIntegrationStep};
  sim::PlantAnalysis analysis = analysis_of(test);
  loop::FloorMonitor floors{analysis, history.response};
  PlatenTransfer transfer{test, controller};
  transfer.records_commands = true;
  loop::ClosedLoop loop{analysis, transfer, loop_settings(test)};
  const auto steps = static_cast<std::size_t>(steps_of(test));
  // A target each integration step; the solver waits at most as long again for
  // each of them.
  const long most = kRestTicks + 2L * 10 * steps_of(test);
  for (long tick = 0; tick < most && loop.targets() <= steps && history.stable; ++tick) {
    const std::size_t ended = loop.steps();
    loop.tick();
    if (loop.steps() > ended) note(analysis, floors, history.response);
    history.stable = loop.target().norm() < test.machine.limits.stroke.norm();
  }
  history.axes = std::move(transfer.history);
  history.commands = std::move(transfer.commands);
  history.limits = transfer.limits;
  return history;
}

std::array<AxisHistory, 2> replay(const PlatenTest& test, const HybridHistory& from,
                                  const Controller& controller) {
  PlatenTransfer transfer{test, controller};
  const VectorXd at_rest = VectorXd::Zero(1);
  for (std::size_t tick = 0; tick < from.commands.size(); ++tick) {
    transfer.move(tick, at_rest);
    transfer.send(tick, from.commands[tick]);
  }
  return std::move(transfer.history);
}

loop::ResponseHistory numerical_loop(const PlatenTest& test) {
  loop::ResponseHistory response{test.plant.floor_names, kIntegrationStep};
  sim::PlantAnalysis analysis = analysis_of(test);
  loop::FloorMonitor floors{analysis, response};
  loop::PerfectMachine machine{test.machine.specimen, kIntegrationStep, kSpecimenSteps};
  loop::ClosedLoopSettings settings;
  settings.period = kIntegrationStep;
  settings.tested.assign(test.axes.begin(), test.axes.end());
  loop::ClosedLoop loop{analysis, machine, settings};
  for (long step = 0; step < steps_of(test); ++step) {
    loop.tick();
    note(analysis, floors, response);
  }
  return response;
}

}  // namespace rths::bench
