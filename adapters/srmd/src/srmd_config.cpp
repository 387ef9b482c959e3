// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd.hpp>

namespace rths::adapters {
namespace {

// One number for both axes, or [long, lat].
void read_pair(const Config& table, const std::string& key, double sim::ServoAxis::*member,
               std::array<sim::ServoAxis, sim::kHorizontalAxes>& axes) {
  if (!table.has(key)) return;
  const auto values = table.numbers(key);
  if (values.size() != axes.size())
    table.fail(key,
               key + " has " + std::to_string(values.size()) + " numbers, expected [long, lat]");
  for (std::size_t i = 0; i < axes.size(); ++i) axes[i].*member = values[i];
}

}  // namespace

sim::TestMachine read_machine(const Config& changes) {
  const Config table = sim::srmd_terms().overlaid(changes);
  sim::TestMachine machine = sim::srmd_machine();
  auto& axes = machine.axes;
  read_pair(table, "position_gain_per_s", &sim::ServoAxis::position_gain, axes);
  read_pair(table, "pressure_gain", &sim::ServoAxis::pressure_gain, axes);
  read_pair(table, "valve_frequency_Hz", &sim::ServoAxis::valve_frequency, axes);
  read_pair(table, "dead_band", &sim::ServoAxis::dead_band, axes);
  read_pair(table, "bulk_modulus_Pa", &sim::ServoAxis::bulk_modulus, axes);
  read_pair(table, "transport_delay_s", &sim::ServoAxis::transport_delay, axes);
  read_pair(table, "effective_mass_kg", &sim::ServoAxis::effective_mass, axes);
  read_pair(table, "force_offset_N", &sim::ServoAxis::force_offset, axes);
  auto& noise = machine.noise;
  noise.displacement = table.number_in("displacement_noise_m", 0, 1, noise.displacement);
  noise.force = table.number_in("force_noise_N", 0, 1e9, noise.force);
  noise.acceleration = table.number_in("acceleration_noise_m_per_s2", 0, 1e3, noise.acceleration);
  machine.has_specimen = !table.flag("empty_table", false);
  machine.terms = sim::read_terms(table, sim::TermOwner::Machine);
  table.reject_unknown_keys();
  return machine;
}

}  // namespace rths::adapters
