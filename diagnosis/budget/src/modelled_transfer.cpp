// SPDX-License-Identifier: Apache-2.0
#include "modelled_transfer.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace rths::budget {
namespace {

template <class Value>
const Value& at(const std::vector<Value>& by_tick, std::size_t tick) {
  return by_tick[std::min(tick, by_tick.size() - 1)];
}

}  // namespace

SentCompensation::SentCompensation(const HybridTest& test) : test_{test} {
  for (std::size_t i = 0; i < inverse_.size(); ++i)
    if (const auto* sent = std::get_if<SentInverse>(&test.compensation[i]))
      inverse_[i].emplace(sent->settings);
}

Eigen::Vector2d SentCompensation::operator()(std::size_t tick, const loop::Command& command,
                                             const Eigen::Vector2d& force) {
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

void ModelledTransfer::move(std::size_t found, const Eigen::VectorXd& forces) {
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

void ModelledTransfer::measure(const Eigen::VectorXd& target, const loop::Command& last) {
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

}  // namespace rths::budget
