// SPDX-License-Identifier: Apache-2.0
#include "modelled_transfer.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "platen.hpp"
#include "sent_compensation.hpp"

namespace rths::budget {

using Eigen::Vector2d;
using Eigen::VectorXd;

struct ModelledTransfer::Model {
  Model(const HybridTest& t, Parts identified, std::size_t first_tick)
      : test{t},
        specimen{has(identified, Part::Specimen) ? t.specimen_identified : t.specimen_simulated},
        machine{has(identified, Part::Machine) ? t.machine_identified : t.machine_simulated},
        compensation{t},
        ideal{t, specimen},
        own_force{machine, t.period},
        known_force{has(identified, Part::Machine)
                        ? with_known_friction(t.machine_simulated, t.correction)
                        : t.machine_simulated,
                    t.period},
        sensors{t.machine_identified, t.period},
        feedback{t.correction, has(identified, Part::Tracking) ? t.target_force : std::nullopt,
                 t.period},
        measures{has(identified, Part::Force)},
        knows_load{has(identified, Part::Machine) && !t.axial_load.empty()},
        ticks{first_tick} {
    if (has(identified, Part::Tracking)) servo.emplace(t, machine, specimen);
  }

  void send(std::size_t controller_tick, const loop::Command& command) {
    if (servo)
      sent.push_back({compensation(controller_tick, command, feedback.ahead()), Vector2d::Zero(),
                      Vector2d::Zero()});
    else
      sent.push_back(ideal.asked_by(command));
  }

  void move(std::size_t found, double compression) {
    const auto& asked = found == 0 || sent.empty() ? rest : sent[std::min(found, sent.size()) - 1];
    load = knows_load ? test.axial_load[std::min(ticks, test.axial_load.size() - 1)] : compression;
    if (servo)
      servo->step(asked.displacement, load, motion);
    else
      ideal.step(asked, load, motion);
    displacement = motion.displacement;
    ++ticks;
    const double time = static_cast<double>(ticks) * test.period;
    const Vector2d own = own_force(motion, time, load);
    table = servo ? servo->table_force : Vector2d{motion.specimen_force + own};
    exact = motion.specimen_force + own - known_force(motion, time, load);
    if (measures) readings = sensors(motion, table, time, load);
  }

  void measure(const VectorXd& target, const loop::Command& last) {
    feedback.step(
        measures ? feedback.corrected(with_noise(), test.target_force_waits)
                 : loop::AxisMeasurement{motion.displacement, motion.acceleration, exact, load},
        target, last);
    for (Eigen::Index i = 0; i < 2; ++i)
      force[i] = test.tested[static_cast<std::size_t>(i)] ? feedback.at_target()[i] : 0;
  }

  [[nodiscard]] loop::AxisMeasurement with_noise() const {
    const std::size_t tick = std::max<std::size_t>(ticks, 1) - 1;
    loop::AxisMeasurement measured = readings;
    measured.axial_load = load;
    for (Eigen::Index i = 0; i < 2; ++i) {
      const auto& noise = test.noise[static_cast<std::size_t>(i)];
      measured.displacement[i] += platen::at(noise.displacement, tick);
      measured.acceleration[i] += platen::at(noise.acceleration, tick);
      measured.force[i] += platen::at(noise.force, tick);
    }
    return measured;
  }

  const HybridTest& test;
  const sim::Bearing& specimen;
  const sim::TestMachine& machine;
  SentCompensation compensation;
  std::optional<platen::ServoTransfer> servo;
  platen::IdealTransfer ideal;
  platen::MachineOwnForce own_force, known_force;
  platen::Sensors sensors;
  loop::ForceFeedback feedback;
  bool measures, knows_load;
  std::size_t ticks;
  double load = 0;                   // on the machine [N]
  std::vector<platen::Motion> sent;  // by tick of the controller
  const platen::Motion rest;
  platen::Platen motion;
  loop::AxisMeasurement readings;  // before the noise
  Vector2d table = Vector2d::Zero(), exact = Vector2d::Zero();
  VectorXd displacement = VectorXd::Zero(2), force = VectorXd::Zero(2);
};

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

ModelledTransfer::ModelledTransfer(const HybridTest& test, Parts identified, std::size_t first_tick)
    : model_{std::make_unique<Model>(test, identified, first_tick)} {}

ModelledTransfer::~ModelledTransfer() = default;

void ModelledTransfer::send(std::size_t controller_tick, const loop::Command& command) {
  model_->send(controller_tick, command);
}

void ModelledTransfer::move(std::size_t found, const VectorXd& forces) {
  model_->move(found, model_->test.specimen_simulated.axial_load + forces[0]);
}

void ModelledTransfer::measure(const VectorXd& target, const loop::Command& last) {
  model_->measure(target, last);
}

const VectorXd& ModelledTransfer::displacement() const { return model_->displacement; }

const VectorXd& ModelledTransfer::force() const { return model_->force; }

}  // namespace rths::budget
