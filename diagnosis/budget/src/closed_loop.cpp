// SPDX-License-Identifier: Apache-2.0
#include <rths/budget/closed_loop.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <rths/core/interrupted.hpp>
#include <rths/loop/closed_loop.hpp>
#include <rths/loop/transfer_system.hpp>
#include <rths/sim/plant_analysis.hpp>

#include "platen.hpp"

namespace rths::budget {
namespace {

using Eigen::Vector2d;
using Eigen::VectorXd;

template <class Value>
const Value& at(const std::vector<Value>& by_tick, std::size_t tick) {
  return by_tick[std::min(tick, by_tick.size() - 1)];
}

/// The compensation as it ran: the references that it sent for a command.
class SentCompensation {
 public:
  explicit SentCompensation(const HybridTest& test);  ///< @setup
  /// One tick of the controller. @param force  of the specimen, as the controller knows it [N]
  [[nodiscard]] Vector2d operator()(std::size_t tick, const loop::Command& command,
                                    const Vector2d& force);

 private:
  [[nodiscard]] double reference_of(std::size_t axis, std::size_t tick,
                                    const loop::Command& command, double force);

  const HybridTest& test_;
  std::array<std::optional<controller::InverseLead>, 2> inverse_;
};

/// The transfer system of a closed loop, each part as simulated or as identified.
class ModelledTransfer final : public loop::TransferSystem {
 public:
  /// @param first_tick  of the machine: the noise and the vertical load of earlier ticks are
  /// skipped
  ModelledTransfer(const HybridTest& test, Parts identified, std::size_t first_tick);

  void send(std::size_t controller_tick, const loop::Command& command) override;
  void move(std::size_t found, const VectorXd& forces) override;
  void measure(const VectorXd& target, const loop::Command& last) override;
  [[nodiscard]] const VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const VectorXd& force() const override { return force_; }

 private:
  [[nodiscard]] loop::AxisMeasurement with_noise() const;

  const HybridTest& test_;
  const sim::Bearing& specimen_;
  const sim::TestMachine& machine_;
  SentCompensation compensation_;
  std::optional<platen::ServoTransfer> servo_;
  platen::IdealTransfer ideal_;
  platen::MachineOwnForce own_force_, known_force_;
  platen::Sensors sensors_;
  loop::ForceFeedback feedback_;
  bool measures_, knows_load_;
  std::size_t ticks_;                 ///< of the machine
  double load_ = 0;                   ///< on the machine [N]
  std::vector<platen::Motion> sent_;  ///< by tick of the controller
  platen::Platen motion_;
  loop::AxisMeasurement readings_;     ///< before the noise
  Vector2d exact_ = Vector2d::Zero();  ///< force of the specimen, exactly measured [N]
  VectorXd displacement_ = VectorXd::Zero(2), force_ = displacement_;
};

SentCompensation::SentCompensation(const HybridTest& test) : test_{test} {
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    if (const auto* sent = std::get_if<SentInverse>(&test.compensation[i]))
      inverse_[i].emplace(sent->settings);
}

Vector2d SentCompensation::operator()(std::size_t tick, const loop::Command& command,
                                      const Vector2d& force) {
  return {reference_of(0, tick, command, force[0]), reference_of(1, tick, command, force[1])};
}

double SentCompensation::reference_of(std::size_t axis, std::size_t tick,
                                      const loop::Command& command, double force) {
  const auto i = static_cast<Eigen::Index>(axis);
  const double x = command.displacement[i];
  if (const auto* sent = std::get_if<SentInverse>(&test_.compensation[axis])) {
    inverse_[axis]->advance(x, force, command.pace);
    return inverse_[axis]->reference(at(sent->coefficients, tick), 1);
  }
  const auto& sent = std::get<std::vector<Lead>>(test_.compensation[axis]);
  if (sent.empty()) return x;
  const Lead& lead = at(sent, tick);
  return lead[0] * x + lead[1] * command.velocity[i] + lead[2] * command.acceleration[i];
}

ModelledTransfer::ModelledTransfer(const HybridTest& test, Parts identified, std::size_t first_tick)
    : test_{test},
      specimen_{has(identified, Part::Specimen) ? test.specimen_identified
                                                : test.specimen_simulated},
      machine_{has(identified, Part::Machine) ? test.machine_identified : test.machine_simulated},
      compensation_{test},
      ideal_{test, specimen_},
      own_force_{machine_, test.period},
      known_force_{has(identified, Part::Machine)
                       ? with_known_friction(test.machine_simulated, test.correction)
                       : test.machine_simulated,
                   test.period},
      sensors_{test.machine_identified, test.period},
      feedback_{test.correction, has(identified, Part::Tracking) ? test.target_force : std::nullopt,
                test.period},
      measures_{has(identified, Part::Force)},
      knows_load_{has(identified, Part::Machine) && !test.axial_load.empty()},
      ticks_{first_tick} {
  if (has(identified, Part::Tracking)) servo_.emplace(test, machine_, specimen_);
}

void ModelledTransfer::send(std::size_t controller_tick, const loop::Command& command) {
  if (servo_)
    sent_.push_back({compensation_(controller_tick, command, feedback_.ahead()), Vector2d::Zero(),
                     Vector2d::Zero()});
  else
    sent_.push_back(ideal_.asked_by(command));
}

void ModelledTransfer::move(std::size_t found, const VectorXd& forces) {
  const platen::Motion asked =
      found == 0 || sent_.empty() ? platen::Motion{} : sent_[std::min(found, sent_.size()) - 1];
  load_ = knows_load_ ? test_.axial_load[std::min(ticks_, test_.axial_load.size() - 1)]
                      : test_.specimen_simulated.axial_load + forces[0];
  if (servo_)
    servo_->step(asked.displacement, load_, motion_);
  else
    ideal_.step(asked, load_, motion_);
  displacement_ = motion_.displacement;
  ++ticks_;
  const double time = static_cast<double>(ticks_) * test_.period;
  const Vector2d own = own_force_(motion_, time, load_);
  const Vector2d table = servo_ ? servo_->table_force : Vector2d{motion_.specimen_force + own};
  exact_ = motion_.specimen_force + own - known_force_(motion_, time, load_);
  if (measures_) readings_ = sensors_(motion_, table, time, load_);
}

void ModelledTransfer::measure(const VectorXd& target, const loop::Command& last) {
  feedback_.step(
      measures_ ? feedback_.corrected(with_noise(), test_.target_force_waits)
                : loop::AxisMeasurement{motion_.displacement, motion_.acceleration, exact_, load_},
      target, last);
  for (Eigen::Index i = 0; i < 2; ++i)
    force_[i] = test_.tested[static_cast<std::size_t>(i)] ? feedback_.at_target()[i] : 0;
}

loop::AxisMeasurement ModelledTransfer::with_noise() const {
  const std::size_t tick = std::max<std::size_t>(ticks_, 1) - 1;
  loop::AxisMeasurement measured = readings_;
  measured.axial_load = load_;
  for (Eigen::Index i = 0; i < 2; ++i) {
    const auto& noise = test_.noise[static_cast<std::size_t>(i)];
    measured.displacement[i] += platen::at(noise.displacement, tick);
    measured.acceleration[i] += platen::at(noise.acceleration, tick);
    measured.force[i] += platen::at(noise.force, tick);
  }
  return measured;
}

constexpr double kRounding = 1e-9;  // of a count of steps times their length [s]

// As identified: a target per integration step.
std::unique_ptr<sim::Substructure> analysis_of(const HybridTest& test) {
  return test.structure->analysis({test.motion, test.implicit_stiffness, test.integration_step,
                                   test.alpha, sim::VerticalFeedback::Model, test.substeps});
}

// A host that is as simulated is never late.
loop::ClosedLoopSettings settings_of(const HybridTest& test, Parts identified) {
  loop::ClosedLoopSettings settings;
  settings.period = test.period;
  settings.rate = test.rate;
  settings.tested.assign(test.tested.begin(), test.tested.end());
  settings.host = test.host;
  settings.targets_act_early = true;
  if (has(identified, Part::Host)) return settings;
  settings.host.order = {};
  settings.host.arrivals.clear();
  return settings;
}

/// In place of a transfer system: the force that a test fed to its integrator, by step.
class RecordedForce final : public loop::TransferSystem {
 public:
  explicit RecordedForce(const std::array<std::vector<double>, 2>& force) : recorded_{force} {}
  void send(std::size_t /*controller_tick*/, const loop::Command& command) override {
    displacement_ = command.displacement;
  }
  void move(std::size_t found, const VectorXd& /*forces*/) override {
    force_ = Vector2d{recorded_[0][found - 1], recorded_[1][found - 1]};
  }
  void measure(const VectorXd& /*target*/, const loop::Command& /*last*/) override {}
  [[nodiscard]] const VectorXd& displacement() const override { return displacement_; }
  [[nodiscard]] const VectorXd& force() const override { return force_; }

 private:
  const std::array<std::vector<double>, 2>& recorded_;
  VectorXd displacement_ = VectorXd::Zero(2), force_ = displacement_;
};

void append(const VectorXd& target, Response& response) {
  response[0].push_back(target[0]);
  response[1].push_back(target[1]);
}

// As simulated: a target per controller period, which is its command.
Response run_with_fine_steps(const HybridTest& test, Parts identified) {
  const double step = test.period / test.rate;  // model time
  const auto analysis =
      test.structure->analysis({test.motion, test.implicit_stiffness, step, test.alpha});
  const auto settings = settings_of(test, identified);
  ModelledTransfer transfer{test, identified,
                            settings.host.order.machine_ticks(test.host.first_target + 1)};
  loop::ClosedLoop loop{*analysis, transfer, settings};
  Response response;
  const auto steps = static_cast<std::size_t>(std::llround(test.duration / step));
  const auto per_sample = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::llround(test.integration_step / step)));
  while (loop.targets() < steps) {
    loop.tick();
    if (loop.targets() % per_sample == 0) append(loop.target(), response);
  }
  return response;
}

// The numerical side as it ran: targets once per integration step, after the time of computing.
Response run_with_its_steps(const HybridTest& test, Parts identified) {
  auto settings = settings_of(test, identified);
  settings.path = {test.command,
                   {test.sampling_delay.begin(), test.sampling_delay.end()},
                   test.target_force && test.target_force->lead_time > 0};
  auto& command = settings.path->settings;
  command.axes = 2;
  command.integration_step = test.integration_step;
  command.simulation_step = test.rate * test.integration_step;
  const auto analysis = analysis_of(test);
  ModelledTransfer transfer{test, identified, 0};
  loop::ClosedLoop loop{*analysis, transfer, settings};
  Response response;
  const auto steps =
      static_cast<std::size_t>(std::ceil(test.duration / test.integration_step - kRounding));
  while (response[0].size() < steps) {
    loop.tick();
    if (loop.targets() > response[0].size()) append(loop.target(), response);
  }
  return response;
}

}  // namespace

sim::TestMachine with_known_friction(sim::TestMachine machine,
                                     const loop::ForceCorrection& correction) {
  constexpr const char* kFriction = "load_dependent_friction";
  const auto* table = std::get_if<loop::TableForceCorrection>(&correction);
  const bool has_it = std::any_of(machine.terms.begin(), machine.terms.end(),
                                  [&](const auto& term) { return term.kind == kFriction; });
  if (table == nullptr || has_it) return machine;
  for (unsigned i = 0; i < 2; ++i) {
    const controller::TableForce& known = table->machine[i];
    if (!(known.load_friction > 0)) continue;
    sim::TermSettings friction;
    friction.kind = kFriction;
    friction.name = fmt::format("{}_{}", kFriction, i);
    friction.axes = 1U << i;
    friction.parameters = {{"friction_coefficient", known.load_friction},
                           {"presliding", known.presliding}};
    machine.terms.push_back(friction);
  }
  return machine;
}

Response closed_loop(const HybridTest& test, Parts identified) {
  stop_if_interrupted();
  return has(identified, Part::Numerical) ? run_with_its_steps(test, identified)
                                          : run_with_fine_steps(test, identified);
}

Response replayed(const HybridTest& test, const std::array<std::vector<double>, 2>& force) {
  const auto analysis = analysis_of(test);
  RecordedForce recorded{force};
  loop::ClosedLoop loop{*analysis, recorded, settings_of(test, kNone)};
  Response response;
  const std::size_t steps = std::min(force[0].size(), force[1].size());
  while (loop.targets() < steps) {
    loop.tick();
    append(loop.target(), response);
  }
  return response;
}

}  // namespace rths::budget
