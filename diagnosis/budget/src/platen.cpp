// SPDX-License-Identifier: Apache-2.0
#include "platen.hpp"

namespace rths::budget::platen {
namespace {

sim::Quantities<double> quantities_of(const Motion& motion, double time, double axial_load) {
  sim::Quantities<double> q;
  q.time = time;
  q.axial_load = axial_load;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    q.displacement[i] = motion.displacement[axis];
    q.velocity[i] = motion.velocity[axis];
    q.acceleration[i] = motion.acceleration[axis];
  }
  return q;
}

sim::TestMachine quiet(sim::TestMachine machine, const sim::TestMachine& terms,
                       const sim::Bearing& specimen) {
  machine.terms = terms.terms;
  for (std::size_t i = 0; i < machine.axes.size(); ++i) {
    machine.axes[i].effective_mass = terms.axes[i].effective_mass;
    machine.axes[i].force_offset = terms.axes[i].force_offset;
  }
  // The identified hydraulics contain the actuator. Sensors come after it.
  std::erase_if(machine.terms, [](const auto& term) {
    const sim::Stage stage = sim::term_kind(term.kind).stage;
    return stage == sim::Stage::Actuator || stage == sim::Stage::Sensor;
  });
  machine.noise = {0, 0, 0};
  machine.specimen = specimen;
  machine.has_specimen = true;
  return machine;
}

}  // namespace

std::vector<sim::TermSettings> terms_of_stage(const sim::TestMachine& machine, sim::Stage stage) {
  std::vector<sim::TermSettings> found;
  for (const auto& term : machine.terms)
    if (sim::term_kind(term.kind).stage == stage) found.push_back(term);
  return found;
}

// platen_inertia reads the acceleration of its quantities; as a term of a machine it adds mass.
Vector2d MachineOwnForce::operator()(const Platen& platen, double time,
                                     double axial_load) noexcept {
  auto q = quantities_of(platen, time, axial_load);
  terms_.advance(q);
  return {q.force[0] + axes_[0].effective_mass * platen.acceleration[0] + axes_[0].force_offset,
          q.force[1] + axes_[1].effective_mass * platen.acceleration[1] + axes_[1].force_offset};
}

Motion IdealTransfer::asked_by(const loop::Command& command) noexcept {
  const double pace = command.pace.share;
  auto q = quantities_of(
      {command.displacement, pace * command.velocity, pace * pace * command.acceleration}, time_,
      0);
  actuator_.advance(q);
  time_ += period_;
  return {{q.displacement[0], q.displacement[1]},
          {q.velocity[0], q.velocity[1]},
          {q.acceleration[0], q.acceleration[1]}};
}

void IdealTransfer::step(const Motion& motion, double axial_load, Platen& platen) noexcept {
  static_cast<Motion&>(platen) = motion;
  platen.specimen_force = specimen_.advance(motion.displacement, motion.velocity, axial_load);
}

ServoTransfer::ServoTransfer(const HybridTest& test, const sim::TestMachine& terms,
                             const sim::Bearing& specimen)
    : period_{test.period}, run_{quiet(test.machine_identified, terms, specimen), period_} {}

void ServoTransfer::step(const Vector2d& reference, double axial_load, Platen& platen) noexcept {
  sim::MachineFeedback feedback;
  static_cast<void>(run_.step(reference, axial_load, feedback));
  platen.velocity = (feedback.displacement - platen.displacement) / period_;
  platen.displacement = feedback.displacement;
  platen.acceleration = feedback.acceleration;
  platen.specimen_force = run_.specimen_force();
  table_force = feedback.force;
}

loop::AxisMeasurement Sensors::operator()(const Platen& platen, const Vector2d& table_force,
                                          double time, double axial_load) noexcept {
  auto q = quantities_of(platen, time, axial_load);
  q.force = {table_force[0], table_force[1]};
  terms_.advance(q);
  return {{q.displacement[0], q.displacement[1]},
          {q.acceleration[0], q.acceleration[1]},
          {q.force[0], q.force[1]},
          axial_load};
}

}  // namespace rths::budget::platen
