// SPDX-License-Identifier: Apache-2.0
//
// Builds the blocks of the vertical force from their [[block]] tables.
#include <fmt/format.h>

#include "block_tables.hpp"

namespace rths::adapters {
namespace {

constexpr double kLargest = 1e15;

double positive(const Config& table, const char* key, double otherwise) {
  return table.number_in(key, 1e-9, kLargest, otherwise);
}

controller::AxialBearing read_bearing(const Config& table) {
  controller::AxialBearing bearing;
  bearing.stiffness = positive(table, "stiffness_N_per_m", bearing.stiffness);
  bearing.softening = table.number_in("softening_per_m2", 0, 1e6, bearing.softening);
  bearing.lift_radius = table.number_in("lift_radius_m", -1e6, 1e6, bearing.lift_radius);
  bearing.series_stiffness =
      table.number_in("series_stiffness_N_per_m", 0, kLargest, bearing.series_stiffness);
  return bearing;
}

controller::SingleActingServo read_servo(const Config& table) {
  controller::SingleActingServo servo;
  servo.position_gain = positive(table, "position_gain_per_s", servo.position_gain);
  servo.valve_frequency = table.number_in("valve_frequency_Hz", 0.1, 1000, servo.valve_frequency);
  servo.valve_damping = table.number_in("valve_damping", 0.05, 10, servo.valve_damping);
  servo.delay = table.number_in("delay_s", 0, 0.1, servo.delay);
  servo.oil_stiffness = positive(table, "oil_stiffness_N_per_m", servo.oil_stiffness);
  servo.supply_force = positive(table, "supply_force_N", servo.supply_force);
  servo.platen_mass = table.number_in("platen_mass_kg", 0, 1e9, servo.platen_mass);
  return servo;
}

bool read_law(const Config& table) {
  const std::string law = table.text("law", "lead");
  if (law != "lead" && law != "cascade")
    table.fail("law", fmt::format("law is '{}', expected lead or cascade", law));
  return law == "cascade";
}

}  // namespace

Block make_vertical_force(const Config& table, const BlockContext& context) {
  const bool is_cascade = read_law(table);
  const double limit = table.number_in("limit_m", 1e-4, 10, 0.127);
  controller::ForceCascadeSettings cascade;
  cascade.period = context.period;
  cascade.gain = positive(table, "cascade_gain_per_s", cascade.gain);
  cascade.lag = table.number_in("cascade_lag_s", 0, 10, cascade.lag);
  cascade.reference_limit = limit;
  const auto bearing = read_bearing(table);
  cascade.stiffness = bearing.stiffness;
  const auto servo = read_servo(table);
  const double servo_stiffness =
      positive(table, "servo_stiffness_N_per_m", bearing.servo_stiffness);
  auto lead = table.placed(
      "name", [&] { return controller::single_acting_vertical(bearing, servo, servo_stiffness); });
  lead.inverse.initial.dead_band =
      table.number_in("dead_band_m", 0, 0.1, lead.inverse.initial.dead_band);
  lead.inverse.period = context.period;
  lead.inverse.largest_reference = limit;
  lead.observer_bandwidth =
      table.number_in("observer_bandwidth_Hz", 0, 100, lead.observer_bandwidth);
  Block block;
  block.inputs = ports<VerticalForceBlock::In::kCount>({{"target", kSingle, "N"},
                                                        {"measured", kSingle, "N"},
                                                        {"horizontal_target", kPerAxis, "m", true},
                                                        {"horizontal", kPerAxis, "m", true},
                                                        {"lost_time", kSingle, "s", true}});
  block.outputs = ports<VerticalForceBlock::Out::kCount>({{"reference", kSingle, "m"},
                                                          {"disturbance", kSingle, "m"},
                                                          {"a0", kSingle, "1"},
                                                          {"a1", kSingle, "s"},
                                                          {"learning", kSingle, "1"},
                                                          {"clipped", kSingle, "1"},
                                                          {"bad_samples", kSingle, "1"}});
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = table.placed("name", [&] {
    return VerticalForceBlock{controller::VerticalForceControl{lead},
                              controller::ForceCascade{cascade}, is_cascade, limit, context.period};
  });
  return block;
}

Block make_lag_correction(const Config& table, const BlockContext& context) {
  controller::LagCorrectionSettings settings;
  settings.period = context.period;
  settings.lag = table.number_in("lag_s", -0.1, 0.1, settings.lag);
  settings.ahead = table.number_in("ahead_s", 0, 0.1, settings.ahead);
  settings.gain_uncertainty = positive(table, "uncertainty_gain", settings.gain_uncertainty);
  settings.lag_uncertainty = positive(table, "uncertainty_lag_s", settings.lag_uncertainty);
  settings.noise = positive(table, "noise_N", settings.noise);
  settings.forgetting = table.number_in("forgetting_s", 0.01, 1000, settings.forgetting);
  settings.cutoff = table.number_in("cutoff_Hz", 0.1, 0.4 / context.period, settings.cutoff);
  Block block;
  block.inputs = ports<LagCorrectionBlock::In::kCount>(
      {{"command", kSingle, "N"}, {"measured", kSingle, "N"}});
  block.outputs = ports<LagCorrectionBlock::Out::kCount>(
      {{"force", kSingle, "N"}, {"gain", kSingle, "1"}, {"lag", kSingle, "s"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = table.placed("name", [&] {
    return LagCorrectionBlock{controller::LagCorrection{settings},
                              Fade{context.period / kFadeTime}};
  });
  return block;
}

}  // namespace rths::adapters
