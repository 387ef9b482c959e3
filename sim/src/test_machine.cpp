// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/test_machine.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

constexpr double kLongestSubstep = 1e-4;  // [s]; oil columns and spools are slower than 20 Hz

double sign(double x) { return x > 0 ? 1.0 : (x < 0 ? -1.0 : 0.0); }

int substeps_of(double period) {
  if (!(period > 0) || !std::isfinite(period))
    throw Error{fmt::format("test machine: period is {} s, expected a positive number", period)};
  return std::max(1, static_cast<int>(std::ceil(period / kLongestSubstep - 1e-9)));
}

// The paper's Table 2, first set-up: F_s and F_d; the presliding length is ours.
constexpr const char* kSrmdTerms = R"(
[coulomb_friction]
friction_force_N = [5100, 8600]
presliding_m = 1e-5
[viscous_friction]
coefficient_N_s_per_m = [716, 870]
)";

// Adds masses that move with the platen to its own. Their force cannot be computed as a term: the
// acceleration depends on it.
TestMachine with_inertia(TestMachine machine) {
  for (const auto& term : machine.terms)
    if (has_trait(term.kind, kInertial))
      for (std::size_t i = 0; i < machine.axes.size(); ++i)
        for (const auto& [name, mass] : term.parameters)
          if (name == "mass" && (term.axes >> i & 1U) != 0) machine.axes[i].effective_mass += mass;
  return machine;
}

constexpr double kLongestDelay = 1;      // [s]
constexpr double kMostDamping = 10;      // of a spool [-]
constexpr double kMostFeedback = 10;     // of pressure [-]
constexpr double kFastestWashout = 100;  // of pressure [Hz]
// An extrapolated resistance drives an oscillation with a damping ratio of -(ω substep)³/8.
constexpr double kFastestSpecimen = 0.1;  // ω substep [-]
constexpr double kUnbounded = std::numeric_limits<double>::max();

struct Bounded {
  const char* key;
  double value, low, high;
};

void require(const Bounded& b) {
  if (b.value >= b.low && b.value <= b.high) return;
  const std::string expected = b.high == kUnbounded ? fmt::format("{} or more", b.low)
                                                    : fmt::format("{} to {}", b.low, b.high);
  throw Error{fmt::format("test machine: {} is {}, expected {}", b.key, b.value, expected)};
}

void require_positive(const char* key, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw Error{fmt::format("test machine: {} is {}, expected a positive number", key, value)};
}

// The model's own rates must be slow enough for the substeps of the integration.
void require_slow(const char* name, double rate, double substep, double most) {
  if (!(rate * substep <= most))
    throw Error{
        fmt::format("test machine: {} is {:.6g} 1/s, expected at most {:.6g}, the limit for "
                    "substeps of {} s",
                    name, rate, most / substep, substep)};
}

void check_hydraulics(const ServoAxis& axis) {
  require_positive("stroke", axis.limits.stroke);
  require_positive("velocity limit", axis.limits.velocity);
  require_positive("force limit", axis.limits.force);
  require_positive("piston_area", axis.piston_area);
  require_positive("oil_volume", axis.oil_volume);
  require_positive("bulk_modulus", axis.bulk_modulus);
  require_positive("supply_pressure", axis.supply_pressure);
  require_positive("rated_flow", axis.rated_flow);
  require_positive("valve_frequency", axis.valve_frequency);
  require_positive("position_gain", axis.position_gain);
  require_positive("effective_mass (with platen_inertia)", axis.effective_mass);
  for (const Bounded& bounded :
       {Bounded{"leakage", axis.leakage, 0, kUnbounded},
        Bounded{"valve_damping", axis.valve_damping, 0, kMostDamping},
        Bounded{"dead_band", axis.dead_band, 0, 1},
        Bounded{"pressure_gain", axis.pressure_gain, 0, kMostFeedback},
        Bounded{"pressure_washout", axis.pressure_washout, 0, kFastestWashout},
        Bounded{"transport_delay", axis.transport_delay, 0, kLongestDelay},
        Bounded{"force_offset", axis.force_offset, -kUnbounded, kUnbounded}})
    require(bounded);
}

void check_rates(const ServoAxis& axis, double substep) {
  const double spool = 2 * std::numbers::pi * axis.valve_frequency;
  require_slow("the rate of the spool (valve_frequency, valve_damping)",
               spool * std::max(1.0, 2 * axis.valve_damping), substep, 1);
  const double oil = 4 * axis.bulk_modulus / axis.oil_volume;
  require_slow("the rate of the oil column (bulk_modulus, oil_volume, effective_mass)",
               axis.piston_area * std::sqrt(oil / axis.effective_mass), substep, 1);
  require_slow("the rate of leakage (leakage, bulk_modulus, oil_volume)", oil * axis.leakage,
               substep, 1);
}

// The specimen with the machine's motion terms in front of it.
Bearing mounted_specimen(const TestMachine& machine) {
  for (const auto& term : machine.terms) check_owner(term, TermOwner::Machine);
  Bearing mounted = machine.has_specimen ? machine.specimen : Bearing{};
  const auto is_mount = [](const auto& term) {
    return term_kind(term.kind).stage == Stage::Motion;
  };
  std::vector<TermSettings> mount;
  std::copy_if(machine.terms.begin(), machine.terms.end(), std::back_inserter(mount), is_mount);
  // The prefix avoids clashes with the specimen's terms.
  for (auto& term : mount) term.name = "machine." + name_of(term);
  mounted.terms.insert(mounted.terms.begin(), mount.begin(), mount.end());
  return mounted;
}

void check(const TestMachine& machine, double substep) {
  require({"displacement_noise", machine.noise.displacement, 0, kUnbounded});
  require({"force_noise", machine.noise.force, 0, kUnbounded});
  require({"acceleration_noise", machine.noise.acceleration, 0, kUnbounded});
  const double stiffness = machine.has_specimen ? largest_stiffness(machine.specimen) : 0;
  for (const auto& axis : machine.axes) {
    check_hydraulics(axis);
    check_rates(axis, substep);
    require_slow("the rate of the specimen on the platen (its stiffness, effective_mass)",
                 std::sqrt(std::max(0.0, stiffness) / axis.effective_mass), substep,
                 kFastestSpecimen);
  }
}

}  // namespace

TestMachineRun::TestMachineRun(const TestMachine& machine, double period)
    : machine_{with_inertia(machine)},
      substeps_{substeps_of(period)},
      substep_{period / substeps_},
      actuator_{terms_of(machine, Stage::Actuator, period)},
      platen_{terms_of(machine, Stage::Machine, substep_)},
      sensors_{terms_of(machine, Stage::Sensor, period)},
      specimen_{mounted_specimen(machine), substep_},
      random_{machine.seed} {
  check(machine_, substep_);
  for (int i = 0; i < kHorizontalAxes; ++i) {
    const auto delay = std::lround(machine_.axes[i].transport_delay / substep_);
    axes_[i].delay_line.assign(static_cast<std::size_t>(std::max(1L, delay)), 0.0);
  }
}

double TestMachineRun::platen_acceleration(int axis, const AxisState& s,
                                           double resistance) const noexcept {
  const ServoAxis& p = machine_.axes[axis];
  return (p.piston_area * s.pressure - resistance) / p.effective_mass;
}

TestMachineRun::AxisState TestMachineRun::rates(int axis, const AxisState& s, double reference,
                                                double resistance) const noexcept {
  const ServoAxis& p = machine_.axes[axis];
  const double demand =
      std::clamp(p.position_gain * (reference - s.x) * p.piston_area / p.rated_flow -
                     p.pressure_gain * (s.pressure - s.slow_pressure) / p.supply_pressure,
                 -1.0, 1.0);
  const double opening =
      std::abs(s.spool) > p.dead_band ? s.spool - sign(s.spool) * p.dead_band : 0;
  const double drop = std::max(0.0, 1 - sign(opening) * s.pressure / p.supply_pressure);
  const double flow = p.rated_flow * opening * std::sqrt(drop);
  const double omega = 2 * std::numbers::pi * p.valve_frequency;
  return {s.v,
          platen_acceleration(axis, s, resistance),
          4 * p.bulk_modulus / p.oil_volume * (flow - p.piston_area * s.v - p.leakage * s.pressure),
          2 * std::numbers::pi * p.pressure_washout * (s.pressure - s.slow_pressure),
          s.spool_rate,
          omega * omega * (demand - s.spool) - 2 * p.valve_damping * omega * s.spool_rate};
}

void TestMachineRun::integrate_substep(int i, double reference) noexcept {
  Axis& axis = axes_[i];
  const double delayed = axis.delay_line[axis.delay_head];
  axis.delay_line[axis.delay_head] = reference;
  axis.delay_head = (axis.delay_head + 1) % axis.delay_line.size();

  const auto moved = [](const AxisState& from, const AxisState& d, double dt) {
    return AxisState{from.x + dt * d.x,
                     from.v + dt * d.v,
                     from.pressure + dt * d.pressure,
                     from.slow_pressure + dt * d.slow_pressure,
                     from.spool + dt * d.spool,
                     from.spool_rate + dt * d.spool_rate};
  };
  // The resistance at the end of this substep is not known yet. Holding it would make it half a
  // substep late, which acts as negative damping. Extrapolation leaves a third-order error.
  const double change = resistance_[i] - last_resistance_[i];
  const double middle = resistance_[i] + change / 2;
  AxisState& s = axis.state;
  const AxisState k1 = rates(i, s, delayed, resistance_[i]);
  const double h = substep_;
  const AxisState k2 = rates(i, moved(s, k1, h / 2), delayed, middle);
  const AxisState k3 = rates(i, moved(s, k2, h / 2), delayed, middle);
  const AxisState k4 = rates(i, moved(s, k3, h), delayed, resistance_[i] + change);
  s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
  s.spool = std::clamp(s.spool, -1.0, 1.0);
  s.pressure =
      std::clamp(s.pressure, -machine_.axes[i].supply_pressure, machine_.axes[i].supply_pressure);
}

bool TestMachineRun::at_limit(int i) const noexcept {
  const AxisLimits& limits = machine_.axes[i].limits;
  const AxisState& s = axes_[i].state;
  return std::abs(s.x) >= limits.stroke || std::abs(s.v) >= limits.velocity ||
         std::abs(s.pressure * machine_.axes[i].piston_area) >= limits.force;
}

double TestMachineRun::draw(double standard_deviation) noexcept {
  return standard_deviation * normal_(random_);
}

Status TestMachineRun::step(const Eigen::Vector2d& reference, double axial_load,
                            MachineFeedback& feedback) noexcept {
  Status status = Status::Ok;
  Eigen::Vector2d clamped = reference;
  for (int i = 0; i < kHorizontalAxes; ++i) {
    const double stroke = machine_.axes[i].limits.stroke;
    clamped[i] = std::clamp(reference[i], -stroke, stroke);
    if (!(std::abs(reference[i]) <= stroke)) status = Status::LimitExceeded;
    if (std::isnan(reference[i])) clamped[i] = axes_[i].state.x;
  }
  const Eigen::Vector2d moved = through_actuator_terms(clamped);
  for (int k = 0; k < substeps_; ++k) integrate_substep(moved, axial_load);
  for (int i = 0; i < kHorizontalAxes; ++i)
    if (at_limit(i)) status = Status::LimitExceeded;
  measure(axial_load, feedback);
  return status;
}

TestMachineRun::Terms TestMachineRun::terms_of(const TestMachine& machine, Stage stage,
                                               double time_step) {
  std::vector<TermSettings> wanted;
  for (const auto& term : machine.terms)
    if (term_kind(term.kind).stage == stage && !has_trait(term.kind, kInertial))
      wanted.push_back(term);
  Composition composition{wanted, time_step};
  std::vector<double> state(composition.states());
  return {std::move(composition), std::move(state)};
}

Eigen::Vector2d TestMachineRun::through_actuator_terms(const Eigen::Vector2d& reference) noexcept {
  Quantities<double> q;
  q.time = time_;
  q.displacement = {reference[0], reference[1]};
  actuator_.composition.set_specimen_force(actuator_.state,
                                           {specimen_force_[0], specimen_force_[1]});
  actuator_.run(q);
  return {q.displacement[0], q.displacement[1]};
}

Quantities<double> TestMachineRun::motion() const noexcept {
  Quantities<double> q;
  q.time = time_;
  for (int i = 0; i < kHorizontalAxes; ++i) {
    q.displacement[i] = axes_[i].state.x;
    q.velocity[i] = axes_[i].state.v;
    q.acceleration[i] = platen_acceleration(i, axes_[i].state, resistance_[i]);
  }
  return q;
}

void TestMachineRun::integrate_substep(const Eigen::Vector2d& reference,
                                       double axial_load) noexcept {
  for (int i = 0; i < kHorizontalAxes; ++i) integrate_substep(i, reference[i]);
  time_ += substep_;
  Quantities<double> q = motion();
  q.axial_load = axial_load;
  platen_.run(q);
  if (machine_.has_specimen)
    specimen_force_ =
        specimen_.advance(true_displacement(), {axes_[0].state.v, axes_[1].state.v}, axial_load);
  last_resistance_ = resistance_;
  resistance_ = specimen_force_ + Eigen::Vector2d{q.force[0], q.force[1]};
}

void TestMachineRun::measure(double axial_load, MachineFeedback& feedback) noexcept {
  Quantities<double> q = motion();
  q.axial_load = axial_load;
  for (int i = 0; i < kHorizontalAxes; ++i) {
    const ServoAxis& axis = machine_.axes[i];
    q.force[i] = axis.piston_area * axes_[i].state.pressure + axis.force_offset;
  }
  sensors_.run(q);
  for (int i = 0; i < kHorizontalAxes; ++i) {
    feedback.displacement[i] = q.displacement[i] + draw(machine_.noise.displacement);
    feedback.acceleration[i] = q.acceleration[i] + draw(machine_.noise.acceleration);
    feedback.force[i] = q.force[i] + draw(machine_.noise.force);
  }
  feedback.axial_load = q.axial_load;
}

Eigen::Vector2d TestMachineRun::true_displacement() const {
  return {axes_[0].state.x, axes_[1].state.x};
}

Config srmd_terms() { return Config::parse(kSrmdTerms, "srmd"); }

TestMachine srmd_machine() {
  TestMachine machine;
  machine.terms = read_terms(srmd_terms());
  ServoAxis& longitudinal = machine.axes[0];
  longitudinal.limits = {1.22, 1.778, 8.9e6};
  ServoAxis& lateral = machine.axes[1];
  lateral.limits = {0.61, 0.762, 4.45e6};
  lateral.piston_area = 0.215;
  lateral.oil_volume = 0.262;
  lateral.rated_flow = 0.25;
  lateral.leakage = 1e-10;
  lateral.effective_mass = 116'836;
  lateral.force_offset = -1'500;
  return machine;
}

}  // namespace rths::sim
