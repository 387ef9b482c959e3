// SPDX-License-Identifier: Apache-2.0
#include "hybrid_loop.hpp"

#include <cmath>
#include <optional>
#include <utility>

#include <rths/adapters/block_settings.hpp>
#include <rths/controller/adaptive_inverse.hpp>
#include <rths/controller/ats.hpp>
#include <rths/controller/force_observer.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/controller/target_exchange.hpp>

#include "specimen_force.hpp"

namespace rths::bench {
namespace {

using Eigen::Vector2d;
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
  double step(const Command& command, double /*measured*/, double /*force*/) override {
    return command[0];
  }
};

class PaperAts final : public Compensator {
 public:
  double step(const Command& command, double measured, double /*force*/) override {
    return ats_.step(command, measured, 1, true);
  }
  [[nodiscard]] Eigen::Vector3d coefficients() const override { return ats_.coefficients(); }

 private:
  controller::Ats ats_{controller::AtsSettings{}};
};

class Inverse final : public Compensator {
 public:
  explicit Inverse(const controller::AdaptiveInverseSettings& settings) : inverse_{settings} {}
  double step(const Command& command, double measured, double force) override {
    return inverse_.step(command[0], measured, force, 1, true);
  }
  [[nodiscard]] Eigen::Vector3d coefficients() const override {
    const auto c = inverse_.coefficients();
    return {c.a0, c.a1, c.a2};
  }

 private:
  controller::AdaptiveInverse inverse_;
};

/// The compensators of both axes and the references that they form.
class Compensation {
 public:
  explicit Compensation(const Controller& controller) : feed_forward_{controller.feed_forward} {
    for (std::size_t i = 0; i < 2; ++i) axes_[i] = controller.compensator(i);
  }
  PlatenReference step(const std::array<Command, 2>& commands, const PlatenFeedback& feedback,
                       const Vector2d& force, double axial_load,
                       std::array<AxisHistory, 2>& history) {
    PlatenReference reference;
    reference.axial_load = axial_load;
    reference.feed_forward = feed_forward_;
    for (std::size_t i = 0; i < 2; ++i) {
      const double measured = feedback.displacement[static_cast<Eigen::Index>(i)];
      reference.displacement[static_cast<Eigen::Index>(i)] =
          axes_[i]->step(commands[i], measured, force[static_cast<Eigen::Index>(i)]);
      history[i].command.push_back(commands[i][0]);
      history[i].measured.push_back(measured);
      history[i].coefficients.push_back(axes_[i]->coefficients());
    }
    return reference;
  }

 private:
  double feed_forward_;
  std::array<std::unique_ptr<Compensator>, 2> axes_;
};

controller::PredictorCorrectorSettings command_settings() {
  controller::PredictorCorrectorSettings settings;
  settings.axes = 2;
  settings.integration_step = settings.simulation_step = kIntegrationStep;
  settings.substeps = static_cast<int>(std::lround(kIntegrationStep / kPeriod)) * kSubsteps;
  return settings;
}

/// Predictor-corrector, its handshake, and force observers, at the controller's period.
class RealTimeTarget {
 public:
  RealTimeTarget(const std::optional<ForceCorrection>& correction, const Vector2d& offset)
      : pc_{command_settings()}, exchange_{{0, 0}, command_settings()}, force_{correction, offset} {
    for (Eigen::VectorXd* v : {&target_.displacement, &target_.velocity, &target_.acceleration})
      v->setZero(2);
  }
  void send(const Vector2d& displacement) {
    target_.displacement = displacement;
    word_ = 1;
  }
  void step(const PlatenFeedback& feedback) {
    force_.step(feedback, target_.displacement, {command(0), command(1)});
    const Eigen::VectorXd displacement = feedback.displacement.head<2>();
    for (int k = 0; k < kSubsteps; ++k) {
      const bool is_new = exchange_.begin(word_);
      pc_.substep(is_new, target_);
      exchange_.end(pc_, displacement, force_.at_target());
    }
    if (exchange_.switch_pc()) word_ = 0;
  }
  [[nodiscard]] Command command(Eigen::Index axis) const {
    return {pc_.command()[axis], pc_.command_velocity()[axis], pc_.command_acceleration()[axis]};
  }
  [[nodiscard]] bool is_waiting() const { return word_ == 0 && exchange_.at_target(); }
  [[nodiscard]] Vector2d held_force() const { return exchange_.held_force(); }
  /// Of the specimen, for the compensator [N]
  [[nodiscard]] const Eigen::VectorXd& force() const { return force_.ahead(); }

 private:
  controller::PredictorCorrector pc_;
  controller::TargetExchange exchange_;
  controller::Target target_;
  double word_ = 0;
  SpecimenForce force_;
};

void note(const sim::PlantAnalysis& analysis, sim::ResponseHistory& response) {
  const Vector2d base = analysis.base_displacement();
  response.displacement_long.push_back(base[0]);
  response.displacement_lat.push_back(base[1]);
  for (std::size_t i = 0; i < response.floors.size(); ++i) {
    const Vector2d a = analysis.floor_acceleration(i);
    response.floors[i].acceleration_long.push_back(a[0]);
    response.floors[i].acceleration_lat.push_back(a[1]);
  }
}

sim::PlantAnalysis analysis_of(const HybridTest& test) {
  return {test.plant,          test.motion, sim::initial_stiffness(test.machine.specimen),
          kIntegrationStep,    kAlpha,      sim::VerticalFeedback::Model,
          kIntegrationSubsteps};
}

sim::ResponseHistory empty_response(const sim::PlantMatrices& plant) {
  sim::ResponseHistory response;
  response.time_step = kIntegrationStep;
  for (const auto& name : plant.floor_names) response.floors.push_back({name, {}, {}});
  return response;
}

Vector2d tested(const HybridTest& test, Vector2d value) {
  for (std::size_t i = 0; i < 2; ++i)
    if (!test.axes[i]) value[static_cast<Eigen::Index>(i)] = 0;
  return value;
}

long steps_of(const HybridTest& test) { return std::lround(test.duration / kIntegrationStep); }

}  // namespace

Controller bare_controller() {
  return {"none", 0, std::nullopt, [](std::size_t) { return std::make_unique<Bare>(); }};
}

Controller paper_controller() {
  return {"paper", kPaperFeedForward, std::nullopt,
          [](std::size_t) { return std::make_unique<PaperAts>(); }};
}

Controller inverse_controller(const sim::machine::PlatenMachine& nominal,
                              const sim::Bearing& bearing, const Config& constants) {
  const std::vector<std::string> axes{"long", "lat"};
  const auto observer =
      adapters::table_force_observer_settings(constants.table("observer"), axes, kPeriod);
  auto inverse = adapters::adaptive_inverse_settings(constants.table("inverse"), axes, kPeriod);
  for (std::size_t axis = 0; axis < inverse.size(); ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    inverse[axis].force_capacity = nominal.limits.force[i];
    inverse[axis].effective_mass = nominal.mass[i];
    inverse[axis].largest_reference = nominal.limits.stroke[i];
  }
  auto target_force = adapters::target_force_settings(constants.table("target_force"), axes,
                                                      kPeriod, kIntegrationStep, &bearing);
  return {
      "inverse", 0,
      ForceCorrection{
          {observer.machine[0], observer.machine[1]}, observer.observer, std::move(target_force)},
      [inverse](std::size_t axis) { return std::make_unique<Inverse>(inverse[axis]); }};
}

HybridHistory run_hybrid(const HybridTest& test, const Controller& controller) {
  HybridHistory history;
  history.response = empty_response(test.plant);
  PlatenRun machine = test.at_rest;
  sim::PlantAnalysis analysis = analysis_of(test);
  RealTimeTarget target{controller.correction, test.machine.transducers.force_offset};
  Compensation compensation{controller};
  const double weight = test.machine.specimen.axial_load;
  PlatenReference reference;
  reference.axial_load = weight;
  PlatenFeedback feedback;
  Vector2d next = Vector2d::Zero();
  long sent = 0, send_at = kRestTicks;
  bool computing = true;
  // A target each integration step; the solver waits at most as long again for
  // each of them.
  const long most = kRestTicks + 2L * 10 * steps_of(test);
  for (long tick = 0; tick < most && sent <= steps_of(test); ++tick) {
    if (machine.step(reference, feedback) != Status::Ok) ++history.limits;
    if (computing && tick == send_at) {
      next = tested(test, analysis.predict());
      target.send(next);
      ++sent;
      computing = false;
    }
    target.step(feedback);
    if (!computing && target.is_waiting()) {
      analysis.correct(target.held_force());
      note(analysis, history.response);
      computing = true;
      send_at = tick + kComputingTicks;
    }
    const std::array<Command, 2> commands{target.command(0), target.command(1)};
    for (std::size_t i = 0; i < 2; ++i) history.commands[i].push_back(commands[i]);
    reference = compensation.step(commands, feedback, target.force(),
                                  weight + analysis.vertical_force(), history.axes);
    history.stable = history.stable && next.norm() < test.machine.limits.stroke.norm();
    if (!history.stable) break;
  }
  return history;
}

std::array<AxisHistory, 2> replay(const HybridTest& test, const HybridHistory& from,
                                  const Controller& controller) {
  std::array<AxisHistory, 2> history;
  PlatenRun machine = test.at_rest;
  Compensation compensation{controller};
  PlatenReference reference;
  reference.axial_load = test.machine.specimen.axial_load;
  PlatenFeedback feedback;
  for (std::size_t tick = 0; tick < from.commands[0].size(); ++tick) {
    static_cast<void>(machine.step(reference, feedback));
    reference = compensation.step({from.commands[0][tick], from.commands[1][tick]}, feedback,
                                  Vector2d::Zero(), test.machine.specimen.axial_load, history);
  }
  return history;
}

sim::ResponseHistory numerical_loop(const HybridTest& test) {
  sim::ResponseHistory response = empty_response(test.plant);
  sim::PlantAnalysis analysis = analysis_of(test);
  const sim::Bearing& bearing = test.machine.specimen;
  sim::BearingRun specimen{bearing, kIntegrationStep / kSpecimenSteps};
  Vector2d at = Vector2d::Zero();
  for (long step = 0; step < steps_of(test); ++step) {
    const Vector2d to = tested(test, analysis.predict());
    const Vector2d velocity = (to - at) / kIntegrationStep;
    Vector2d force = Vector2d::Zero();
    for (int k = 1; k <= kSpecimenSteps; ++k)
      force = specimen.advance(at + (to - at) * k / kSpecimenSteps, velocity,
                               bearing.axial_load + analysis.vertical_force());
    at = to;
    analysis.correct(tested(test, force));
    note(analysis, response);
  }
  return response;
}

}  // namespace rths::bench
