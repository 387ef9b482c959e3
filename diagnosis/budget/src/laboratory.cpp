// SPDX-License-Identifier: Apache-2.0
#include "laboratory.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "platen.hpp"

namespace rths::budget {

using Eigen::Vector2d;

namespace platen {  // named, because a member of Laboratory::Model has this type

/// The correction of the measured force, of one kind or the other; none: the force itself.
class CorrectedForce {
 public:
  CorrectedForce(const ForceCorrection& correction, double period) {
    for (std::size_t i = 0; i < 2; ++i)
      if (const auto* paper = std::get_if<MachineForceCorrection>(&correction))
        by_slope_.emplace_back(paper->machine[i], period, paper->slope_samples);
      else if (const auto* table = std::get_if<TableForceCorrection>(&correction))
        by_table_.emplace_back(table->machine[i], table->settings);
  }
  double operator()(std::size_t axis, const controller::TableSample& measured) noexcept {
    if (!by_slope_.empty())
      return by_slope_[axis].step(measured.displacement, measured.acceleration, measured.force);
    return by_table_.empty() ? measured.force : by_table_[axis].step(measured);
  }
  /// The displacement that belongs to the last corrected force.
  [[nodiscard]] double displacement(std::size_t axis, double measured) const noexcept {
    return by_table_.empty() ? measured : by_table_[axis].displacement();
  }

 private:
  std::vector<controller::ForceObserver> by_slope_;
  std::vector<controller::TableForceObserver> by_table_;
};

}  // namespace platen

struct Laboratory::Model {
  Model(const HybridTest& t, Parts identified, std::size_t first_tick)
      : test{t},
        specimen{has(identified, Part::Specimen) ? t.specimen_identified : t.specimen_simulated},
        machine{has(identified, Part::Machine) ? t.machine_identified : t.machine_simulated},
        ideal{t, specimen},
        force{machine, t.period},
        known_force{has(identified, Part::Machine)
                        ? with_known_friction(t.machine_simulated, t.correction)
                        : t.machine_simulated,
                    t.period},
        sensors{t.machine_identified, t.period},
        corrected_force{t.correction, t.period},
        measures{has(identified, Part::Force)},
        knows_load{has(identified, Part::Machine) && !t.axial_load.empty()},
        ticks{first_tick} {
    if (has(identified, Part::Tracking)) servo.emplace(t, machine, specimen);
    if (servo && t.target_force) target_force.emplace(*t.target_force);
  }

  void send(const Vector2d& reference, const Command& command) {
    sent.push_back(servo ? platen::Motion{reference, Vector2d::Zero(), Vector2d::Zero()}
                         : ideal.asked_by(command));
  }

  void move(std::size_t found, double compression) {
    const auto& asked = found == 0 || sent.empty() ? rest : sent[std::min(found, sent.size()) - 1];
    load = knows_load ? test.axial_load[std::min(ticks, test.axial_load.size() - 1)] : compression;
    if (servo)
      servo->step(asked.displacement, load, motion);
    else
      ideal.step(asked, load, motion);
    ++ticks;
    const double time = static_cast<double>(ticks) * test.period;
    const Vector2d own = force(motion, time, load);
    table = servo ? servo->table_force : Vector2d{motion.specimen_force + own};
    exact = motion.specimen_force + own - known_force(motion, time, load);
    if (measures) readings = sensors(motion, table, time, load);
  }

  const Vector2d& feed_back(const Vector2d& target, const Command& last) {
    Vector2d displacement = motion.displacement, acceleration = motion.acceleration;
    fed_back = exact;
    if (measures) measure(displacement, acceleration);
    specimen_force = fed_back;
    if (!target_force) return fed_back;
    target_force->step(
        {target.data(), displacement.data(), acceleration.data(), fed_back.data(),
         last.displacement.data(), last.velocity.data(), last.acceleration.data(), load},
        true);
    fed_back += target_force->correction();
    if (test.target_force->lead_time > 0) specimen_force = target_force->ahead();
    return fed_back;
  }

  // Motion and force as the sensors read them, with their noise.
  void measure(Vector2d& displacement, Vector2d& acceleration) {
    const std::size_t tick = std::max<std::size_t>(ticks, 1) - 1;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto axis = static_cast<std::size_t>(i);
      const auto& noise = test.noise[axis];
      displacement[i] = readings.displacement[i] + platen::at(noise.displacement, tick);
      acceleration[i] = readings.acceleration[i] + platen::at(noise.acceleration, tick);
      const double measured = readings.force[i] + platen::at(noise.force, tick);
      fed_back[i] = corrected_force(axis, {displacement[i], acceleration[i], measured, load});
      if (test.target_force_waits)
        displacement[i] = corrected_force.displacement(axis, displacement[i]);
    }
  }

  const HybridTest& test;
  const sim::Bearing& specimen;
  const sim::TestMachine& machine;
  std::optional<platen::ServoTransfer> servo;
  platen::IdealTransfer ideal;
  platen::MachineOwnForce force, known_force;
  platen::Sensors sensors;
  platen::CorrectedForce corrected_force;
  std::optional<controller::TargetForce> target_force;
  bool measures, knows_load;
  std::size_t ticks;
  double load = 0;                   // on the machine [N]
  std::vector<platen::Motion> sent;  // by tick of the controller
  const platen::Motion rest;
  platen::Platen motion;
  platen::Readings readings;
  Vector2d table = Vector2d::Zero(), exact = Vector2d::Zero(), fed_back = Vector2d::Zero(),
           specimen_force = Vector2d::Zero();
};

sim::TestMachine with_known_friction(sim::TestMachine machine, const ForceCorrection& correction) {
  constexpr const char* kFriction = "load_dependent_friction";
  const auto* table = std::get_if<TableForceCorrection>(&correction);
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

Laboratory::Laboratory(const HybridTest& test, Parts identified, std::size_t first_tick)
    : model_{std::make_unique<Model>(test, identified, first_tick)} {}

Laboratory::~Laboratory() = default;

void Laboratory::send(const Vector2d& reference, const Command& command) {
  model_->send(reference, command);
}

void Laboratory::move(std::size_t found, double compression) { model_->move(found, compression); }

std::size_t Laboratory::ticks() const { return model_->ticks; }

const Vector2d& Laboratory::feed_back(const Vector2d& target, const Command& last) {
  return model_->feed_back(target, last);
}

const Vector2d& Laboratory::displacement() const { return model_->motion.displacement; }

const Vector2d& Laboratory::specimen_force() const { return model_->specimen_force; }

}  // namespace rths::budget
