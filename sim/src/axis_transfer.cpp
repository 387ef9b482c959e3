// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/axis_transfer.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rths::sim {
namespace {

constexpr double kHeadroom = 4;  // of the valve over the velocity limit [-]

/// z = x + c F, the valve, and the slow force.
struct State {
  double z = 0, spool = 0, rate = 0, slow_force = 0;
};
State moved(const State& from, const State& d, double dt) {
  return {from.z + dt * d.z, from.spool + dt * d.spool, from.rate + dt * d.rate,
          from.slow_force + dt * d.slow_force};
}

/// Signals that are linear between samples. A held reference is known at the middle of its period.
class Input {
 public:
  Input(const AxisTransfer& system, const TransferRecord& record)
      : record_{record}, shift_{0.5 - system.transport_delay / record.period} {}
  [[nodiscard]] double reference(double periods) const {
    return at(record_.reference, periods + shift_);
  }
  [[nodiscard]] double force(double periods) const { return at(record_.force, periods); }

 private:
  static double at(const std::vector<double>& values, double x) {
    if (x <= 0) return values.front();
    const auto i = static_cast<std::size_t>(x);
    if (i + 1 >= values.size()) return values.back();
    const double part = x - static_cast<double>(i);
    return values[i] + part * (values[i + 1] - values[i]);
  }
  const TransferRecord& record_;
  double shift_;
};

State rates(const AxisTransfer& p, const State& s, double reference, double force) {
  const double omega = 2 * std::numbers::pi * p.valve_frequency;
  const double x = s.z - p.compliance * force;
  const double demand = p.gain * (reference - x) - p.pressure_feedback * (force - s.slow_force);
  const double band = p.gain * p.dead_band;
  const double opening = s.spool - std::clamp(s.spool, -band, band);
  const double load = (opening > 0 ? force : -force) / p.supply_force;
  const double flow = opening * std::sqrt(std::max(0.0, 1 - load));
  return {flow - p.leakage * force, s.rate,
          omega * omega * (demand - s.spool) - 2 * p.valve_damping * omega * s.rate,
          2 * std::numbers::pi * p.pressure_washout * (force - s.slow_force)};
}

}  // namespace

double AxisTransfer::delay() const { return 1 / gain + transport_delay; }

std::vector<double> predicted(const AxisTransfer& system, const TransferRecord& record) {
  const Input input{system, record};
  const double h = record.period;
  std::vector<double> x(record.reference.size());
  State s{record.displacement.front() + system.compliance * record.force.front(), 0, 0};
  x[0] = record.displacement.front();
  for (std::size_t n = 1; n < x.size(); ++n) {
    const double end = static_cast<double>(n), begin = end - 1, middle = end - 0.5;
    const auto at = [&](const State& state, double periods) {
      return rates(system, state, input.reference(periods), input.force(periods));
    };
    const State k1 = at(s, begin), k2 = at(moved(s, k1, h / 2), middle);
    const State k3 = at(moved(s, k2, h / 2), middle), k4 = at(moved(s, k3, h), end);
    s = moved(moved(moved(moved(s, k1, h / 6), k2, h / 3), k3, h / 3), k4, h / 6);
    x[n] = s.z - system.compliance * input.force(end);
  }
  return x;
}

ServoAxis servo_axis(const AxisTransfer& system, ServoAxis axis) {
  const double fastest = kHeadroom * axis.limits.velocity;  // Q_r/A
  const double area = system.supply_force / axis.supply_pressure;
  axis.piston_area = area;
  axis.rated_flow = fastest * area;
  axis.position_gain = system.gain;
  axis.transport_delay = system.transport_delay;
  axis.valve_frequency = system.valve_frequency;
  axis.valve_damping = system.valve_damping;
  axis.dead_band = system.gain * system.dead_band / fastest;
  axis.pressure_gain = system.pressure_feedback * system.supply_force / fastest;
  axis.pressure_washout = system.pressure_washout;
  axis.oil_volume = 4 * axis.bulk_modulus * system.compliance * area * area;
  axis.leakage = system.leakage * area * area;
  return axis;
}

}  // namespace rths::sim
