// SPDX-License-Identifier: Apache-2.0
#include "laboratory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include <rths/sim/term.hpp>

namespace rths::budget {

using Eigen::Vector2d;

namespace platen {  // named, because the members of Laboratory::Model have these types

std::vector<sim::TermSettings> terms_of_stage(const sim::TestMachine& machine, sim::Stage stage) {
  std::vector<sim::TermSettings> found;
  for (const auto& term : machine.terms)
    if (sim::term_kind(term.kind).stage == stage) found.push_back(term);
  return found;
}

/// Terms with their state.
class RunningTerms {
 public:
  RunningTerms(const std::vector<sim::TermSettings>& terms, double period)
      : composition_{terms, period}, state_(composition_.states()) {}
  void advance(sim::Quantities<double>& q) noexcept { composition_.advance(state_, q); }

 private:
  sim::Composition composition_;
  std::vector<double> state_;
};

/// Motion of the platen and the forces on it, at the end of a controller period.
struct Platen {
  Vector2d displacement = Vector2d::Zero(), velocity = Vector2d::Zero(),
           acceleration = Vector2d::Zero();
  Vector2d specimen_force = Vector2d::Zero();
};

sim::Quantities<double> quantities_of(const Platen& platen, double time, double axial_load) {
  sim::Quantities<double> q;
  q.time = time;
  q.axial_load = axial_load;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    q.displacement[i] = platen.displacement[axis];
    q.velocity[i] = platen.velocity[axis];
    q.acceleration[i] = platen.acceleration[axis];
  }
  return q;
}

/// The machine's own force, as it moves the platen [N].
class MachineOwnForce {
 public:
  MachineOwnForce(const sim::TestMachine& machine, double period)
      : terms_{terms_of_stage(machine, sim::Stage::Machine), period}, axes_{machine.axes} {
    // platen_inertia reads the acceleration of its quantities; as a term of a machine it adds mass.
  }
  Vector2d operator()(const Platen& platen, double time, double axial_load) noexcept {
    auto q = quantities_of(platen, time, axial_load);
    terms_.advance(q);
    return {q.force[0] + axes_[0].effective_mass * platen.acceleration[0] + axes_[0].force_offset,
            q.force[1] + axes_[1].effective_mass * platen.acceleration[1] + axes_[1].force_offset};
  }

 private:
  RunningTerms terms_;
  std::array<sim::ServoAxis, 2> axes_;
};

/// Moves the platen as the reference says. Its rates are differences.
class IdealTransfer {
 public:
  IdealTransfer(const HybridTest& test, const sim::Bearing& specimen)
      : period_{test.period},
        actuator_{terms_of_stage(test.machine_simulated, sim::Stage::Actuator), period_},
        specimen_{specimen, period_} {}

  void step(const Vector2d& reference, double axial_load, Platen& platen) noexcept {
    sim::Quantities<double> q;
    q.time = time_;
    q.displacement = {reference[0], reference[1]};
    actuator_.advance(q);
    time_ += period_;
    const Vector2d displacement{q.displacement[0], q.displacement[1]};
    const Vector2d velocity = (displacement - platen.displacement) / period_;
    platen.acceleration = (velocity - platen.velocity) / period_;
    platen.velocity = velocity;
    platen.displacement = displacement;
    platen.specimen_force = specimen_.advance(displacement, velocity, axial_load);
  }

 private:
  double period_, time_ = 0;
  RunningTerms actuator_;
  sim::BearingRun specimen_;
};

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

/// Moves the platen by the identified hydraulics.
class ServoTransfer {
 public:
  ServoTransfer(const HybridTest& test, const sim::TestMachine& terms, const sim::Bearing& specimen)
      : period_{test.period}, run_{quiet(test.machine_identified, terms, specimen), period_} {}

  void step(const Vector2d& reference, double axial_load, Platen& platen) noexcept {
    sim::MachineFeedback feedback;
    static_cast<void>(run_.step(reference, axial_load, feedback));
    platen.velocity = (feedback.displacement - platen.displacement) / period_;
    platen.displacement = feedback.displacement;
    platen.acceleration = feedback.acceleration;
    platen.specimen_force = run_.specimen_force();
    table_force = feedback.force;
  }

  Vector2d table_force = Vector2d::Zero();

 private:
  double period_;
  sim::TestMachineRun run_;
};

/// What the sensors read, before their noise.
struct Readings {
  Vector2d displacement = Vector2d::Zero(), acceleration = Vector2d::Zero(),
           force = Vector2d::Zero();
};

/// The sensor terms of a machine.
class Sensors {
 public:
  Sensors(const sim::TestMachine& machine, double period)
      : terms_{terms_of_stage(machine, sim::Stage::Sensor), period} {}
  Readings operator()(const Platen& platen, const Vector2d& table_force, double time,
                      double axial_load) noexcept {
    auto q = quantities_of(platen, time, axial_load);
    q.force = {table_force[0], table_force[1]};
    terms_.advance(q);
    return {{q.displacement[0], q.displacement[1]},
            {q.acceleration[0], q.acceleration[1]},
            {q.force[0], q.force[1]}};
  }

 private:
  RunningTerms terms_;
};

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

constexpr std::size_t kReach = 400;  // of the parabola that is no noise, samples

// The largest noise: a multiple of its standard deviation at rest. Unlimited without rest.
double limit_of(const std::vector<double>& noise, std::size_t at_rest) {
  constexpr std::size_t kFewest = 100;  // samples
  constexpr double kMostDeviations = 3;
  if (at_rest < kReach + kFewest || at_rest > noise.size())
    return std::numeric_limits<double>::infinity();
  double sum = 0;
  for (std::size_t i = kReach; i < at_rest; ++i) sum += noise[i] * noise[i];
  return kMostDeviations * std::sqrt(sum / static_cast<double>(at_rest - kReach));
}

std::vector<double> noise_beside(const std::vector<double>& measured,
                                 const std::vector<double>& modelled, std::size_t at_rest) {
  std::vector<double> noise = measured;
  for (std::size_t i = 0; i < std::min(noise.size(), modelled.size()); ++i) noise[i] -= modelled[i];
  noise = noise_of(noise, kReach);
  const double most = limit_of(noise, at_rest);
  for (double& value : noise) value = std::clamp(value, -most, most);
  return noise;
}

double at(const std::vector<double>& values, std::size_t tick) {
  return tick < values.size() ? values[tick] : 0;
}

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

  void move(const Vector2d& reference, double compression) {
    load = knows_load ? test.axial_load[std::min(ticks, test.axial_load.size() - 1)] : compression;
    if (servo)
      servo->step(reference, load, motion);
    else
      ideal.step(reference, load, motion);
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
    target_force->step({target.data(), displacement.data(), acceleration.data(), fed_back.data(),
                        last.displacement.data(), last.velocity.data(), last.acceleration.data()},
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
  double load = 0;  // on the machine [N]
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

void Laboratory::move(const Vector2d& reference, double compression) {
  model_->move(reference, compression);
}

std::size_t Laboratory::ticks() const { return model_->ticks; }

const Vector2d& Laboratory::feed_back(const Vector2d& target, const Command& last) {
  return model_->feed_back(target, last);
}

const Vector2d& Laboratory::displacement() const { return model_->motion.displacement; }

const Vector2d& Laboratory::specimen_force() const { return model_->specimen_force; }

std::array<MeasuredNoise, 2> sensor_noise(const HybridTest& test,
                                          const std::array<TransferRecord, 2>& records) {
  platen::ServoTransfer laboratory{test, test.machine_identified, test.specimen_identified};
  platen::Sensors sensors{test.machine_identified, test.period};
  platen::Platen motion;
  std::array<MeasuredNoise, 2> modelled;
  const std::size_t ticks = std::max(records[0].reference.size(), records[1].reference.size());
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const double load = test.axial_load.empty()
                            ? test.specimen_identified.axial_load
                            : test.axial_load[std::min(tick, test.axial_load.size() - 1)];
    laboratory.step(
        {platen::at(records[0].reference, tick), platen::at(records[1].reference, tick)}, load,
        motion);
    const auto read =
        sensors(motion, laboratory.table_force, static_cast<double>(tick + 1) * test.period, load);
    for (Eigen::Index i = 0; i < 2; ++i) {
      auto& axis = modelled[static_cast<std::size_t>(i)];
      axis.displacement.push_back(read.displacement[i]);
      axis.acceleration.push_back(read.acceleration[i]);
      axis.force.push_back(read.force[i]);
    }
  }
  std::array<MeasuredNoise, 2> noise;
  for (std::size_t i = 0; i < 2; ++i) {
    const auto beside = [&](const std::vector<double>& measured, const std::vector<double>& model) {
      return platen::noise_beside(measured, model, test.first_target);
    };
    noise[i] = {beside(records[i].displacement, modelled[i].displacement),
                beside(records[i].acceleration, modelled[i].acceleration),
                beside(records[i].force, modelled[i].force)};
  }
  return noise;
}

}  // namespace rths::budget
