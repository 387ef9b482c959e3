// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/machine/platen_run.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <rths/core/error.hpp>

namespace rths::sim::machine {

using Eigen::Matrix3d, Eigen::Vector2d, Eigen::Vector3d;

namespace {

constexpr double kSettling = 3;  // before the test begins [s]

// Of fixed size: Eigen's comma initializer copies blocks of a size known at run time only.
Vector6 join(const Vector3d& head, const Vector3d& tail) {
  Vector6 joined;
  joined.head<3>() = head;
  joined.tail<3>() = tail;
  return joined;
}

Vector6 wrench(const Vector3d& arm, const Vector3d& force) { return join(force, arm.cross(force)); }

double clamped(double value, double limit, bool& exceeded) {
  if (!(std::abs(value) <= limit)) exceeded = true;
  return std::clamp(value, -limit, limit);
}

constexpr double kLongestSubstep = 1e-4;  // [s]
constexpr double kFastestMode = 0.1;      // ω substep [-]

void require_slow(const char* name, double rate, double substep, double most) {
  if (!(rate * substep <= most))
    throw Error{
        fmt::format("machine: {} is {:.6g} 1/s, expected at most {:.6g}, the limit for "
                    "substeps of {} s",
                    name, rate, most / substep, substep)};
}

double lightest(const PlatenMachine& m) { return m.mass.head<2>().minCoeff(); }

void check_rates(const PlatenMachine& m, double substep) {
  for (const Actuator* a : {&m.along_long, &m.along_lat, &m.vertical}) {
    const double spool = 2 * std::numbers::pi * a->valve_frequency;
    require_slow("the rate of a spool (valve_frequency, valve_damping)",
                 spool * std::max(1.0, 2 * a->valve_damping), substep, kFastestMode);
    const double oil = oil_stiffness(*a, m.supply, 0) / (a->piston_area * a->piston_area);
    require_slow("the rate of leakage", oil * a->leakage, substep, kFastestMode);
  }
  require_slow("the fastest mode on the oil columns",
               2 * std::numbers::pi * natural_frequencies(m)[5], substep, kFastestMode);
  const double shear = m.has_specimen ? largest_stiffness(m.specimen) : 0;
  const double friction = m.friction.coulomb.maxCoeff() / m.friction.law.presliding;
  require_slow("the rate of the specimen's shear on the platen",
               std::sqrt((shear + friction) / lightest(m)), substep, kFastestMode);
  if (!m.carries_load()) return;
  require_slow("the rate of the specimen's compression on the platen",
               std::max(std::sqrt(m.vertical_specimen.stiffness / m.mass[2]),
                        m.vertical_specimen.damping / m.mass[2]),
               substep, kFastestMode);
}

// Each actuator reaches all corners of the platen's strokes.
void check_reach(const PlatenMachine& m) {
  for (std::size_t i = 0; i < kHorizontal; ++i) {
    const double middle = (m.swivel[i] - m.base[i]).norm();
    for (unsigned corner = 0; corner < 8; ++corner) {
      Eigen::Vector3d at = m.limits.stroke;
      for (int axis = 0; axis < 3; ++axis)
        if ((corner >> static_cast<unsigned>(axis) & 1U) != 0) at[axis] = -at[axis];
      const double moved = (at + m.swivel[i] - m.base[i]).norm() - middle;
      if (std::abs(moved) > m.actuator(i).stroke)
        throw Error{
            fmt::format("machine: horizontal actuator {} moves by {:.4g} m when the platen "
                        "is at a corner of its strokes, expected at most its stroke, {} m",
                        i + 1, moved, m.actuator(i).stroke)};
    }
  }
}

int substeps_of(double period) {
  if (!(period > 0) || !std::isfinite(period))
    throw Error{fmt::format("machine: period is {} s, expected a positive number", period)};
  return std::max(1, static_cast<int>(std::ceil(period / kLongestSubstep - 1e-9)));
}

void check(const PlatenMachine& m, double substep) {
  check_rates(m, substep);
  check_reach(m);
  const double most = m.limits.force[2] - m.weight();
  if (m.carries_load() && !(m.specimen.axial_load >= 0 && m.specimen.axial_load <= most))
    throw Error{fmt::format("machine: the specimen's axial load is {} N, expected 0 to {} N",
                            m.specimen.axial_load, most)};
}

}  // namespace

PlatenRun::PlatenRun(const PlatenMachine& machine, double period)
    : machine_{machine},
      substeps_{substeps_of(period)},
      substep_{period / substeps_},
      period_{period},
      bearing_{machine.has_specimen ? machine.specimen : Bearing{}, substep_},
      random_{machine.seed} {
  check(machine_, substep_);
  const Transducers& t = machine_.transducers;
  displacement_filter_.fill({t.displacement_filter, substep_});
  force_filter_.fill({t.force_filter, substep_});
  acceleration_filter_.fill({t.acceleration_filter, substep_});
  const auto delay = std::lround(machine_.transport_delay / period);
  delay_line_.resize(static_cast<std::size_t>(std::max(0L, delay)));
  const Coordinates at_middle = coordinates(Pose{}, Matrix3d::Identity());
  for (std::size_t i = 0; i < kActuators; ++i) middle_[i] = at_middle[i].value;
  deflection_.fill(Vector2d::Zero());  // Eigen does not
  state_.gas = machine_.supply.gas_volume;
  if (machine_.carries_load())
    rest_height_ = machine_.specimen.axial_load / machine_.vertical_specimen.stiffness;
  settle();
}

// The vertical actuators carry platen and specimen. Their servos need some time to find the flow
// that replaces leakage.
void PlatenRun::settle() {
  PlatenReference reference;
  reference.axial_load = machine_.carries_load() ? machine_.specimen.axial_load : 0;
  for (auto& waiting : delay_line_) waiting = reference;
  const double share = (machine_.weight() + reference.axial_load) / kVertical;
  for (std::size_t i = kHorizontal; i < kActuators; ++i) {
    auto& s = state_.actuators[i];
    s.pressure = s.slow_pressure = share / machine_.vertical.piston_area;
  }
  filter(true);
  set_targets(reference);
  for (int i = 0; i * period_ < kSettling; ++i) {
    run_force_loop(reference.axial_load);
    for (int k = 0; k < substeps_; ++k) integrate_substep();
  }
  state_.gas = machine_.supply.gas_volume;
}

void PlatenRun::strike(const Vector6& rates) {
  state_.velocity = rates.head<3>();
  state_.angular_velocity = rates.tail<3>();
}

PlatenRun::Coordinates PlatenRun::coordinates(const Pose& pose, const Matrix3d& R) const noexcept {
  Coordinates found;
  for (std::size_t i = 0; i < kHorizontal; ++i)
    found[i] = actuator_length(machine_.base[i], R * machine_.swivel[i], pose.position);
  for (std::size_t i = 0; i < kVertical; ++i)
    found[kHorizontal + i] = pad_height(machine_.foot[i], machine_.depth, R, pose.position);
  return found;
}

double PlatenRun::compression(const Pose& pose, const Vector3d& velocity,
                              const Matrix3d& R) const noexcept {
  if (!machine_.carries_load()) return 0;
  const VerticalSpecimen& v = machine_.vertical_specimen;
  const Vector3d at = pose.position + machine_.top * R.col(2);
  const double u2 = at.head<2>().squaredNorm();
  double stiffness = v.stiffness;
  double shortening = rest_height_ + at[2] - machine_.top;
  double rate = velocity[2];
  const bool is_bearing = machine_.has_specimen;  // rollers neither soften nor lift
  if (is_bearing && v.radius_of_gyration > 0) {
    const double slenderness = std::numbers::pi * v.radius_of_gyration;
    stiffness /= 1 + 3 * u2 / (slenderness * slenderness);
  }
  if (is_bearing && v.pendulum_radius > 0) {
    shortening += u2 / (2 * v.pendulum_radius);
    rate += at.head<2>().dot(velocity.head<2>()) / v.pendulum_radius;
  }
  return std::max(0.0, stiffness * shortening + v.damping * rate);
}

double PlatenRun::axial_load() const {
  return compression(state_.pose, state_.velocity, state_.pose.rotation());
}

// Change of the force of a pad above the floor's slab, by which the platen lifts its arm.
double PlatenRun::push_of(const State& s, const Vector3d& arm, const Vector3d& r,
                          const Vector3d& spin) const noexcept {
  const Outriggers& o = machine_.outriggers;
  return o.stiffness * (s.pose.position[2] + r[2] - arm[2]) +
         o.damping * (s.velocity[2] + spin[0] * r[1] - spin[1] * r[0]);
}

// Weight, outriggers and the specimen's compression: all but actuators, friction and shear.
Vector6 PlatenRun::support_force(const State& s, const Matrix3d& R) const noexcept {
  Vector6 total = wrench(machine_.top * R.col(2), {0, 0, -compression(s.pose, s.velocity, R)});
  total[2] -= machine_.weight();
  const Vector3d spin = R * s.angular_velocity;
  for (const auto& arm : machine_.outriggers.arm)
    total += wrench(R * arm, {0, 0, machine_.outriggers.pair(push_of(s, arm, R * arm, spin))});
  return total;
}

PlatenRun::Evaluation PlatenRun::rates(const State& s, const Vector6& resistance) const noexcept {
  const Matrix3d R = s.pose.rotation();
  const Coordinates found = coordinates(s.pose, R);
  const Vector6 motion = join(s.velocity, R * s.angular_velocity);
  const double pressure = machine_.supply.pressure_at(s.gas);
  Evaluation e;
  double drawn = 0;
  for (std::size_t i = 0; i < kActuators; ++i) {
    const Actuator& actuator = machine_.actuator(i);
    const auto [rates, flow] = machine::rates(
        actuator, machine_.supply, s.actuators[i],
        {found[i].value - middle_[i], found[i].jacobian.dot(motion), targets_.displacement[i],
         targets_.velocity[i], i < kHorizontal ? targets_.feed_forward : 0},
        pressure);
    e.rates.actuators[i] = rates;
    drawn += flow;
    e.actuator_force += actuator.piston_area * s.actuators[i].pressure * found[i].jacobian;
  }
  const Vector6 total = e.actuator_force + support_force(s, R) - resistance;
  const Vector3d moment = R.transpose() * total.tail<3>();
  const Vector3d& w = s.angular_velocity;
  e.rates.pose = {s.velocity, angle_rates(s.pose.angles, w)};
  e.rates.velocity = total.head<3>().cwiseQuotient(machine_.mass);
  e.rates.angular_velocity =
      (moment - w.cross(machine_.inertia.cwiseProduct(w))).cwiseQuotient(machine_.inertia);
  e.rates.gas = machine_.supply.gas_rate(pressure, drawn);
  return e;
}

void PlatenRun::add(const State& from, const State& rates, double dt, State& to) noexcept {
  to.pose.position = from.pose.position + dt * rates.pose.position;
  to.pose.angles = from.pose.angles + dt * rates.pose.angles;
  to.velocity = from.velocity + dt * rates.velocity;
  to.angular_velocity = from.angular_velocity + dt * rates.angular_velocity;
  to.gas = from.gas + dt * rates.gas;
  for (std::size_t i = 0; i < kActuators; ++i) {
    const ActuatorState &a = from.actuators[i], &d = rates.actuators[i];
    to.actuators[i] = {a.pilot + dt * d.pilot, a.spool + dt * d.spool, a.pressure + dt * d.pressure,
                       a.slow_pressure + dt * d.slow_pressure};
  }
}

void PlatenRun::integrate_substep() noexcept {
  // Holding the resistance would make it half a substep late, which acts as negative damping.
  const Vector6 middle = resistance_ + (resistance_ - last_resistance_) / 2;
  now_ = rates(state_, middle);
  filter(false);
  State half;
  add(state_, now_.rates, substep_ / 2, half);
  add(state_, rates(half, middle).rates, substep_, state_);
  const double pressure = supply_pressure();
  for (std::size_t i = 0; i < kActuators; ++i)
    apply_limits(machine_.actuator(i), pressure, state_.actuators[i]);
  update_resistance();
}

void PlatenRun::update_resistance() noexcept {
  const Matrix3d R = state_.pose.rotation();
  const Vector3d spin = R * state_.angular_velocity;
  const double load = axial_load();
  last_resistance_ = resistance_;
  resistance_.setZero();
  friction_.setZero();
  for (std::size_t i = 0; i < kSurfaces; ++i) {
    const Vector3d arm = friction_arm(i, R);
    const Vector3d velocity = state_.velocity + spin.cross(arm);
    const Vector2d coulomb = coulomb_of(i, R, spin);
    Vector3d force = Vector3d::Zero();
    for (int axis = 0; axis < 2; ++axis)
      force[axis] = machine_.friction.law.advance(deflection_[i][axis], velocity[axis],
                                                  coulomb[axis], substep_) +
                    machine_.friction.viscous[axis] / kSurfaces * velocity[axis];
    friction_ += force.head<2>();
    resistance_ += wrench(arm, force);
  }
  if (!machine_.carries_load()) return;
  const Vector3d top = machine_.top * R.col(2);
  const Vector2d u = (state_.pose.position + top).head<2>();
  const Vector2d v = (state_.velocity + spin.cross(top)).head<2>();
  if (machine_.has_specimen) specimen_force_ = bearing_.advance(u, v, load);
  const Vector2d& F = specimen_force_;
  resistance_ += wrench(top, {F[0], F[1], 0});
  // Both ends of the specimen are clamped, and each carries half of the moment. Rollers roll half
  // of the way, so their load has the same arm.
  const double h = machine_.vertical_specimen.height;
  resistance_.tail<3>() -=
      Vector3d{u[1] * load + h * F[1], -(u[0] * load + h * F[0]), u[0] * F[1] - u[1] * F[0]} / 2;
}

Vector3d PlatenRun::friction_arm(std::size_t surface, const Matrix3d& R) const noexcept {
  if (surface < 2 * kArms) return R * machine_.outriggers.arm[surface / 2];
  return -machine_.depth * R.col(2);
}

// Normal force times coefficient, and the surface's share of the constant part.
Vector2d PlatenRun::coulomb_of(std::size_t surface, const Matrix3d& R,
                               const Vector3d& spin) const noexcept {
  const PlatenFriction& f = machine_.friction;
  double normal_part = 0;
  if (surface < 2 * kArms) {
    const Vector3d& arm = machine_.outriggers.arm[surface / 2];
    const double push = push_of(state_, arm, R * arm, spin);
    normal_part = f.coefficient * machine_.outriggers.pad(surface % 2 == 0 ? push : -push);
  } else {
    double load = 0;
    for (std::size_t i = kHorizontal; i < kActuators; ++i)
      load += machine_.vertical.piston_area * state_.actuators[i].pressure;
    normal_part =
        f.coefficient * load + f.boundary_coefficient * std::max(0.0, load - f.lift_capacity());
  }
  return f.coulomb / kSurfaces + Vector2d::Constant(normal_part);
}

void PlatenRun::run_force_loop(double reference) noexcept {
  if (!machine_.carries_load()) return;
  const double stroke = machine_.limits.stroke[2];
  const double error = reference - (filtered_force_[2] - machine_.weight());
  force_correction_ += machine_.force_loop.gain * period_ * error / machine_.force_loop.stiffness;
  force_correction_ = std::clamp(force_correction_, -stroke, stroke);
  for (std::size_t i = kHorizontal; i < kActuators; ++i)
    targets_.displacement[i] = vertical_targets_[i - kHorizontal] + force_correction_;
}

void PlatenRun::set_targets(const PlatenReference& reference) noexcept {
  const Pose pose{reference.displacement.head<3>(), reference.displacement.tail<3>()};
  const Coordinates wanted = coordinates(pose, pose.rotation());
  for (std::size_t i = 0; i < kActuators; ++i) {
    const double displacement = wanted[i].value - middle_[i];
    if (i < kHorizontal) {
      targets_.velocity[i] = (displacement - targets_.displacement[i]) / period_;
      targets_.displacement[i] = displacement;
    } else {
      vertical_targets_[i - kHorizontal] = displacement;
    }
  }
  targets_.feed_forward = reference.feed_forward;
}

Status PlatenRun::step(const PlatenReference& reference, PlatenFeedback& feedback) noexcept {
  bool exceeded = false;
  PlatenReference held = reference;
  for (int i = 0; i < 6; ++i) {
    const double limit = i < 3 ? machine_.limits.stroke[i] : machine_.limits.rotation;
    const double now = i < 3 ? state_.pose.position[i] : state_.pose.angles[i - 3];
    held.displacement[i] = clamped(reference.displacement[i], limit, exceeded);
    if (std::isnan(reference.displacement[i])) held.displacement[i] = now;
  }
  const double most = machine_.limits.force[2] - machine_.weight();
  if (!(reference.axial_load >= 0 && reference.axial_load <= most)) exceeded = true;
  held.axial_load =
      std::isnan(reference.axial_load) ? axial_load() : std::clamp(reference.axial_load, 0.0, most);
  held.feed_forward =
      std::isfinite(reference.feed_forward) ? std::clamp(reference.feed_forward, 0.0, 2.0) : 0;
  if (!delay_line_.empty()) {
    std::swap(held, delay_line_[delay_head_]);
    delay_head_ = (delay_head_ + 1) % delay_line_.size();
  }
  set_targets(held);
  run_force_loop(held.axial_load);
  for (int k = 0; k < substeps_; ++k) integrate_substep();
  measure(feedback);
  return exceeded ? Status::LimitExceeded : limited();
}

Status PlatenRun::limited() const noexcept {
  const PlatenLimits& limits = machine_.limits;
  bool exceeded = false;
  for (int i = 0; i < 3; ++i) {
    exceeded = exceeded || std::abs(state_.pose.position[i]) >= limits.stroke[i] ||
               std::abs(state_.velocity[i]) >= limits.velocity[i] ||
               std::abs(now_.actuator_force[i]) >= limits.force[i] ||
               std::abs(state_.pose.angles[i]) >= limits.rotation;
  }
  return exceeded ? Status::LimitExceeded : Status::Ok;
}

double PlatenRun::supply_pressure() const { return machine_.supply.pressure_at(state_.gas); }

PlatenEnergy PlatenRun::energy() const {
  PlatenEnergy e;
  const Vector3d& v = state_.velocity;
  const Vector3d& w = state_.angular_velocity;
  e.kinetic = (v.dot(machine_.mass.cwiseProduct(v)) + w.dot(machine_.inertia.cwiseProduct(w))) / 2;
  e.potential = machine_.weight() * state_.pose.position[2];
  const Matrix3d R = state_.pose.rotation();
  const Coordinates found = coordinates(state_.pose, R);
  for (std::size_t i = 0; i < kActuators; ++i) {
    const Actuator& actuator = machine_.actuator(i);
    const double force = actuator.piston_area * state_.actuators[i].pressure;
    e.oil +=
        force * force / 2 / oil_stiffness(actuator, machine_.supply, found[i].value - middle_[i]);
  }
  for (const auto& arm : machine_.outriggers.arm) {
    const double lift = state_.pose.position[2] + (R * arm)[2] - arm[2];
    e.outriggers += machine_.outriggers.stiffness * lift * lift;
  }
  return e;
}

}  // namespace rths::sim::machine
