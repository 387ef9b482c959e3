// SPDX-License-Identifier: Apache-2.0
//
// Reads the file of a machine. Every key is required, so that the file shows the whole machine.
#include <string>

#include <fmt/format.h>

#include <rths/sim/machine/platen_machine.hpp>

namespace rths::sim::machine {
namespace {

constexpr double kLargest = 1e12;
constexpr double kSmallest = 1e-12;

double positive(const Config& table, const std::string& key) {
  return table.number_in(key, kSmallest, kLargest);
}
double not_negative(const Config& table, const std::string& key) {
  return table.number_in(key, 0, kLargest);
}

template <int kSize>
Eigen::Matrix<double, kSize, 1> vector(const Config& table, const std::string& key, double low) {
  const auto values = table.numbers(key);
  if (values.size() != kSize)
    table.fail(key, fmt::format("{} has {} numbers, expected {}", key, values.size(), kSize));
  for (const double value : values)
    if (!(value >= low && value <= kLargest))
      table.fail(key, fmt::format("{} holds {}, expected {} to {}", key, value, low, kLargest));
  return Eigen::Map<const Eigen::Matrix<double, kSize, 1>>(values.data());
}

template <class Point, std::size_t kCount>
void read_points(const Config& table, const std::string& key, std::array<Point, kCount>& points) {
  const auto rows = table.rows(key);
  constexpr auto kSize = static_cast<std::size_t>(Point::RowsAtCompileTime);
  if (rows.size() != kCount || rows[0].size() != kSize)
    table.fail(key, fmt::format("{} has another shape, expected {} points of {} numbers", key,
                                kCount, kSize));
  for (std::size_t i = 0; i < kCount; ++i) points[i] = Eigen::Map<const Point>(rows[i].data());
}

Actuator read_actuator(const Config& table, bool single_acting) {
  Actuator a;
  a.single_acting = single_acting;
  a.piston_area = positive(table, "piston_area_m2");
  a.stroke = positive(table, "stroke_m");
  a.dead_length = positive(table, "dead_length_m");
  a.cushion_length = positive(table, "cushion_length_m");
  a.rated_velocity = positive(table, "rated_velocity_m_per_s");
  a.flow_saturation = positive(table, "flow_saturation");
  a.dead_band = table.number_in("dead_band", 0, 0.5);
  a.valve_frequency = positive(table, "valve_frequency_Hz");
  a.valve_damping = table.number_in("valve_damping", 0.05, 10);
  a.spool_slew = positive(table, "spool_slew_per_s");
  a.leakage = not_negative(table, "leakage_m3_per_Pa_s");
  a.position_gain = positive(table, "position_gain_per_s");
  a.pressure_gain = table.number_in("pressure_gain", 0, 10);
  a.pressure_washout = not_negative(table, "pressure_washout_Hz");
  table.reject_unknown_keys();
  return a;
}

void read_platen(const Config& table, PlatenMachine& m) {
  m.mass = vector<3>(table, "mass_kg", kSmallest);
  m.inertia = vector<3>(table, "inertia_kg_m2", kSmallest);
  m.depth = positive(table, "depth_m");
  m.top = positive(table, "top_m");
  table.reject_unknown_keys();
}

void read_limits(const Config& table, PlatenLimits& limits) {
  limits.stroke = vector<3>(table, "stroke_m", kSmallest);
  limits.velocity = vector<3>(table, "velocity_m_per_s", kSmallest);
  limits.force = vector<3>(table, "force_N", kSmallest);
  limits.rotation = table.number_in("rotation_rad", kSmallest, 0.5);
  table.reject_unknown_keys();
}

void read_supply(const Config& table, Supply& supply) {
  supply.pressure = positive(table, "pressure_Pa");
  supply.bulk_modulus = positive(table, "bulk_modulus_Pa");
  supply.gas_volume = positive(table, "gas_volume_m3");
  supply.gas_exponent = table.number_in("gas_exponent", 1, 3);
  supply.pump_flow = not_negative(table, "pump_flow_m3_per_s");
  supply.pump_pressure = positive(table, "pump_pressure_Pa");
  table.reject_unknown_keys();
}

void read_friction(const Config& table, PlatenFriction& friction) {
  friction.coulomb = vector<2>(table, "coulomb_N", 0);
  friction.viscous = vector<2>(table, "viscous_N_s_per_m", 0);
  friction.coefficient = table.number_in("coefficient", 0, 1);
  friction.boundary_coefficient = table.number_in("boundary_coefficient", 0, 1);
  friction.lift_pressure = positive(table, "lift_pressure_Pa");
  friction.pad_area = positive(table, "pad_area_m2");
  friction.law.presliding = positive(table, "presliding_m");
  friction.law.stribeck_ratio = table.number_in("stribeck_ratio", 1, 10);
  friction.law.stribeck_velocity = positive(table, "stribeck_velocity_m_per_s");
  friction.law.micro_damping = table.number_in("micro_damping_s", 0, 0.01);
  table.reject_unknown_keys();
}

void read_transducers(const Config& table, Transducers& t) {
  t.displacement_noise = not_negative(table, "displacement_noise_m");
  t.rotation_noise = not_negative(table, "rotation_noise_rad");
  t.force_noise = not_negative(table, "force_noise_N");
  t.vertical_force_noise = not_negative(table, "vertical_force_noise_N");
  t.moment_noise = not_negative(table, "moment_noise_N_m");
  t.acceleration_noise = not_negative(table, "acceleration_noise_m_per_s2");
  t.displacement_filter = table.number_in("displacement_filter_Hz", 1, 4'000);
  t.force_filter = table.number_in("force_filter_Hz", 1, 4'000);
  t.acceleration_filter = table.number_in("acceleration_filter_Hz", 1, 4'000);
  t.force_offset = vector<2>(table, "force_offset_N", -kLargest);
  table.reject_unknown_keys();
}

void read_vertical_specimen(const Config& table, VerticalSpecimen& v) {
  v.stiffness = positive(table, "stiffness_N_per_m");
  v.damping = not_negative(table, "damping_N_s_per_m");
  v.radius_of_gyration = not_negative(table, "radius_of_gyration_m");
  v.pendulum_radius = not_negative(table, "pendulum_radius_m");
  v.height = not_negative(table, "height_m");
  table.reject_unknown_keys();
}

void read_outriggers(const Config& table, Outriggers& outriggers) {
  read_points(table, "arm_m", outriggers.arm);
  outriggers.preload = not_negative(table, "preload_N");
  outriggers.stiffness = not_negative(table, "stiffness_N_per_m");
  outriggers.damping = not_negative(table, "damping_N_s_per_m");
  table.reject_unknown_keys();
}

}  // namespace

PlatenMachine read_platen_machine(const Config& table) {
  if (const auto format = table.integer("machine"); format != kPlatenMachineFormat)
    table.fail("machine", fmt::format("format of the machine is {}, this program reads {}", format,
                                      kPlatenMachineFormat));
  PlatenMachine m;
  m.title = table.text("title", "");
  read_platen(table.table("platen"), m);
  read_limits(table.table("limits"), m.limits);
  const Config geometry = table.table("geometry");
  read_points(geometry, "base_m", m.base);
  read_points(geometry, "swivel_m", m.swivel);
  read_points(geometry, "foot_m", m.foot);
  geometry.reject_unknown_keys();
  m.along_long = read_actuator(table.table("actuator_long"), false);
  m.along_lat = read_actuator(table.table("actuator_lat"), false);
  m.vertical = read_actuator(table.table("actuator_vert"), true);
  read_supply(table.table("supply"), m.supply);
  read_outriggers(table.table("outriggers"), m.outriggers);
  read_friction(table.table("friction"), m.friction);
  read_transducers(table.table("transducers"), m.transducers);
  read_vertical_specimen(table.table("vertical_specimen"), m.vertical_specimen);
  const Config loop = table.table("force_loop");
  m.force_loop.gain = not_negative(loop, "gain_per_s");
  m.force_loop.stiffness = positive(loop, "stiffness_N_per_m");
  loop.reject_unknown_keys();
  m.transport_delay = table.number_in("transport_delay_s", 0, 1);
  table.reject_unknown_keys();
  return m;
}

}  // namespace rths::sim::machine
