// SPDX-License-Identifier: Apache-2.0
//
// Builds the blocks of adaptive inverse, table force observer and target force from [[block]]
// tables.
#include "block_tables.hpp"

namespace rths::adapters {
namespace {

// One value per axis and coefficient.
std::vector<controller::InverseCoefficients> read_coefficients(
    const Config& table, const std::string& prefix, const BlockContext& context,
    const controller::InverseCoefficients& otherwise) {
  std::vector<controller::InverseCoefficients> axes(context.axes(), otherwise);
  const auto read = [&](const char* key, double controller::InverseCoefficients::*value) {
    const auto values = per_axis(table, prefix + key, context, otherwise.*value);
    for (std::size_t i = 0; i < axes.size(); ++i) axes[i].*value = values[i];
  };
  read("a0", &controller::InverseCoefficients::a0);
  read("a1_s", &controller::InverseCoefficients::a1);
  read("a2_s2", &controller::InverseCoefficients::a2);
  read("a3_s3", &controller::InverseCoefficients::a3);
  read("load_m_per_N", &controller::InverseCoefficients::load);
  read("load_rate_m_s_per_N", &controller::InverseCoefficients::load_rate);
  read("dead_band_m", &controller::InverseCoefficients::dead_band);
  read("flow_loss_s", &controller::InverseCoefficients::flow_loss);
  return axes;
}

}  // namespace

Block make_adaptive_inverse(const Config& table, const BlockContext& context) {
  controller::AdaptiveInverseSettings settings;
  settings.period = context.period;
  const auto initial = read_coefficients(table, "", context, settings.initial);
  const auto uncertainty = read_coefficients(table, "uncertainty_", context, settings.uncertainty);
  const auto capacity = per_axis(table, "force_capacity_N", context, settings.force_capacity);
  const auto mass = per_axis(table, "effective_mass_kg", context, settings.effective_mass);
  const auto limits = per_axis(table, "limits", context, settings.largest_reference);
  settings.a4 = table.number_in("a4_s4", 0, 1e-3, settings.a4);
  settings.lead_time = table.number_in("lead_time_s", 0, 1, settings.lead_time);
  settings.smoothing = table.number_in("smoothing_s", 1e-5, 0.1, settings.smoothing);
  settings.forgetting = table.number_in("forgetting_s", 0.1, 1000, settings.forgetting);
  settings.error = table.number_in("error_m", 1e-6, 1, settings.error);
  settings.cutoff = table.number_in("cutoff_Hz", 0.1, 1000, settings.cutoff);
  settings.informative_speed =
      table.number_in("informative_speed_m_per_s", 0, 10, settings.informative_speed);
  settings.largest_error = table.number_in("largest_error_m", 1e-6, 10, settings.largest_error);
  AdaptiveInverseBlock block_kind{{}, Fade{context.period / kFadeTime}};
  for (std::size_t i = 0; i < context.axes(); ++i) {
    settings.initial = initial[i];
    settings.uncertainty = uncertainty[i];
    settings.force_capacity = capacity[i];
    settings.effective_mass = mass[i];
    settings.largest_reference = limits[i];
    block_kind.compensators.push_back(
        table.placed("name", [&] { return controller::AdaptiveInverse{settings}; }));
  }
  Block block;
  block.inputs = {
      {"command", kPerAxis, "m"}, {"measured", kPerAxis, "m"}, {"force", kPerAxis, "N"}};
  block.outputs = {{"reference", kPerAxis, "m"},  {"a0", kPerAxis, "1"},
                   {"a1", kPerAxis, "s"},         {"a2", kPerAxis, "s2"},
                   {"learning", kPerAxis, "1"},   {"clipped", kPerAxis, "1"},
                   {"bad_samples", kPerAxis, "1"}};
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = std::move(block_kind);
  return block;
}

Block make_table_force_observer(const Config& table, const BlockContext& context) {
  const auto mass = per_axis(table, "effective_mass_kg", context, 0);
  const auto coulomb = per_axis(table, "coulomb_friction_N", context, 0);
  const auto load = per_axis(table, "load_friction", context, 0);
  const auto viscous = per_axis(table, "viscous_friction_N_s_per_m", context, 0);
  const auto offset = per_axis(table, "force_offset_N", context, 0);
  const auto presliding = per_axis(table, "presliding_m", context, 1e-3);
  const auto delay = per_axis(table, "accelerometer_delay_s", context, 0);
  controller::TableObserverSettings settings;
  settings.period = context.period;
  settings.velocity_bandwidth =
      table.number_in("velocity_bandwidth_Hz", 0.01, 100, settings.velocity_bandwidth);
  settings.cutoff = table.number_in("cutoff_Hz", 0, 1000, settings.cutoff);
  TableForceObserverBlock observer;
  for (std::size_t i = 0; i < context.axes(); ++i)
    observer.observers.push_back(table.placed("name", [&] {
      return controller::TableForceObserver{
          {mass[i], coulomb[i], load[i], viscous[i], offset[i], presliding[i], delay[i]}, settings};
    }));
  Block block;
  block.inputs = {{"displacement", kPerAxis, "m"},
                  {"acceleration", kPerAxis, "m/s2"},
                  {"force", kPerAxis, "N"},
                  {"axial_load", kSingle, "N", true}};
  block.outputs = {{"force", kPerAxis, "N"},
                   {"velocity", kPerAxis, "m/s"},
                   {"machine_force", kPerAxis, "N"},
                   {"bad_samples", kPerAxis, "1"}};
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  block.kind = std::move(observer);
  return block;
}

Block make_target_force(const Config& table, const BlockContext& context) {
  controller::TargetForceSettings settings;
  settings.axes = static_cast<int>(context.axes());
  settings.period = context.period;
  settings.reach = table.numbers("reach_m", settings.reach);
  settings.forgetting = table.number_in("forgetting_s", 0.1, 1000, settings.forgetting);
  settings.informative_speed =
      table.number_in("informative_speed_m_per_s", 0, 10, settings.informative_speed);
  settings.motion_bandwidth =
      table.number_in("motion_bandwidth_Hz", 0.01, 40, settings.motion_bandwidth);
  Block block;
  block.inputs = {{"target", kPerAxis, "m"},
                  {"displacement", kPerAxis, "m"},
                  {"acceleration", kPerAxis, "m/s2"},
                  {"force", kPerAxis, "N"}};
  block.outputs = {{"force", kPerAxis, "N"},
                   {"correction", kPerAxis, "N"},
                   {"strength", kSingle, "N"},
                   {"learning", kSingle, "1"},
                   {"bad_samples", kSingle, "1"}};
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = table.placed("name", [&] {
    return TargetForceBlock{controller::TargetForce{settings}, Fade{context.period / kFadeTime}};
  });
  return block;
}

}  // namespace rths::adapters
