// SPDX-License-Identifier: Apache-2.0
//
// Builds control blocks from [[block]] tables, with the helpers of all such functions.
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/experiment/block_settings.hpp>

#include "block_tables.hpp"

namespace rths::adapters {
namespace {

constexpr std::pair<double, double> kLead{-1, 1};  // far beyond a machine's delay [s], [s2]

// Warns of a delay that is long, and refuses one that is too long.
std::vector<int> read_sampling_delays(const Config& table, const BlockContext& context,
                                      const controller::PredictorCorrectorSettings& settings) {
  auto delays = experiment::sampling_delays(table, context.run.axes, context.period);
  for (const int delay : delays) {
    const double ratio = static_cast<double>(delay) / settings.substeps;
    switch (controller::judge_delay(delay, settings)) {
      case controller::DelayRating::Fine:
        break;
      case controller::DelayRating::Warned:
        write_message(
            fmt::format("{}: warning: the sampling delay is {:.2f} of the step, above 0.6\n",
                        table.where("sampling_delay_s"), ratio));
        break;
      case controller::DelayRating::Refused:
        table.fail("sampling_delay_s",
                   fmt::format("the sampling delay is {:.2f} of the step, expected less than {:g}",
                               ratio, controller::refused_delay_ratio(settings)));
    }
  }
  return delays;
}

Eigen::Vector3d three(const Config& table, const std::string& key,
                      const Eigen::Vector3d& otherwise) {
  const auto values = table.numbers(key, {otherwise[0], otherwise[1], otherwise[2]});
  if (values.size() != 3)
    table.fail(key,
               fmt::format("{} has {} numbers, expected three: a0, a1, a2", key, values.size()));
  return {values[0], values[1], values[2]};
}

// One start for all axes, or one per axis: a0, a1, a2 of long, then of lat.
std::vector<Eigen::Vector3d> ats_starts(const Config& table, const BlockContext& context,
                                        const Eigen::Vector3d& otherwise) {
  const auto values = table.numbers("initial", {});
  if (values.size() <= 3) return std::vector(context.axes(), three(table, "initial", otherwise));
  std::vector<Eigen::Vector3d> starts;
  for (const auto& axis : context.run.axes) {
    const std::size_t at = 3 * experiment::index_of_axis(axis);
    if (values.size() % 3 != 0 || at >= values.size())
      table.fail("initial", fmt::format("initial has {} numbers, expected three, or three for each "
                                        "axis to '{}'",
                                        values.size(), axis));
    starts.emplace_back(values[at], values[at + 1], values[at + 2]);
  }
  return starts;
}

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

void add_parameter(Block& block, const Config& table, const std::string& name,
                   const std::string& unit, double otherwise, const Range& range) {
  block.parameters.push_back({name, unit, table.number(name, otherwise), range});
}

Block make_predictor_corrector(const Config& table, const BlockContext& context) {
  auto settings = experiment::predictor_corrector_settings(table);
  const bool is_single = table.flag("single", false);
  const std::string unit = table.text("unit", "m");
  if (unit != "m" && unit != "N")
    table.fail("unit", fmt::format("unit is '{}', expected m or N", unit));
  const std::string second_rate = unit == "m" ? "m/s2" : "";  // no unit of the map
  settings.axes = is_single ? 1 : static_cast<int>(context.axes());
  settings.integration_step = context.run.integration_step;
  settings.simulation_step = context.run.simulation_step;
  settings.substeps = static_cast<int>(std::lround(settings.simulation_step / context.period));
  Block block;
  const bool each = !is_single;
  block.inputs = ports<PredictorCorrectorBlock::In::kCount>(
      {{"new_target", kSingle, "1"},
       {"target", each, unit},
       {"displacement", each, unit},
       {"force", each, "N"},
       {"target_velocity", each, unit + "/s", true},
       {"target_acceleration", each, second_rate, true}});
  block.outputs = ports<PredictorCorrectorBlock::Out::kCount>({{"command", each, unit},
                                                               {"velocity", each, unit + "/s"},
                                                               {"acceleration", each, second_rate},
                                                               {"held_displacement", each, unit},
                                                               {"held_force", each, "N"},
                                                               {"at_target", kSingle, "1"},
                                                               {"switch_pc", kSingle, "1"},
                                                               {"state", kSingle, "1"},
                                                               {"counter", kSingle, "1"},
                                                               {"stopped", kSingle, "1"},
                                                               {"correct_time", kSingle, "s"},
                                                               {"predict_time", kSingle, "s"},
                                                               {"slow_down_time", kSingle, "s"},
                                                               {"targets", kSingle, "1"},
                                                               {"target_time", kSingle, "s"},
                                                               {"lost_time", kSingle, "s"}});
  const auto delays =
      is_single ? std::vector<int>(1) : read_sampling_delays(table, context, settings);
  block.kind = table.placed("name", [&] {
    return PredictorCorrectorBlock{settings, delays, context.period};
  });
  return block;
}

Block make_ats(const Config& table, const BlockContext& context) {
  controller::AtsSettings settings;
  settings.period = context.period;
  const auto starts = ats_starts(table, context, settings.initial);
  settings.lowest = three(table, "lowest", settings.lowest);
  settings.highest = three(table, "highest", settings.highest);
  settings.largest_change = three(table, "largest_change", settings.largest_change);
  settings.threshold = table.number_in("threshold_m", 0, 1, settings.threshold);
  settings.window = table.number_in("window_s", 0.01, 100, settings.window);
  settings.decimation =
      static_cast<int>(table.integer_in("decimation", 1, 1000, settings.decimation));
  settings.filter_order =
      static_cast<int>(table.integer_in("filter_order", 2, 8, settings.filter_order));
  settings.filter_cutoff = table.number_in("filter_cutoff_Hz", 0.1, 1000, settings.filter_cutoff);
  settings.smoothing = static_cast<int>(table.integer_in("smoothing", 1, 100, settings.smoothing));
  settings.quiet_rms = table.number_in("quiet_rms_m", 0, 1, settings.quiet_rms);
  Block block;
  block.inputs = ports<AtsBlock::In::kCount>({{"command", kPerAxis, "m"},
                                              {"velocity", kPerAxis, "m/s"},
                                              {"acceleration", kPerAxis, "m/s2"},
                                              {"measured", kPerAxis, "m"}});
  block.outputs = ports<AtsBlock::Out::kCount>({{"reference", kPerAxis, "m"},
                                                {"a0", kPerAxis, "1"},
                                                {"a1", kPerAxis, "s"},
                                                {"a2", kPerAxis, "s2"},
                                                {"limited", kPerAxis, "1"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  AtsBlock block_kind{{}, Fade{context.period / kFadeTime}};
  for (const auto& start : starts) {
    settings.initial = start;
    block_kind.compensators.push_back(
        table.placed("name", [&] { return controller::Ats{settings}; }));
  }
  block.kind = std::move(block_kind);
  return block;
}

Block make_feed_forward(const Config& table, const BlockContext& context) {
  Block block;
  block.inputs = ports<FeedForwardBlock::In::kCount>({{"reference", kPerAxis, "m"},
                                                      {"velocity", kPerAxis, "m/s"},
                                                      {"acceleration", kPerAxis, "m/s2"}});
  block.outputs = ports<FeedForwardBlock::Out::kCount>({{"reference", kPerAxis, "m"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "velocity_gain_s", "s", 0, kLead);
  add_parameter(block, table, "acceleration_gain_s2", "s2", 0, kLead);
  block.kind = FeedForwardBlock{Fade{context.period / kFadeTime}};
  return block;
}

Block make_force_observer(const Config& table, const BlockContext& context) {
  const auto settings = experiment::force_observer_settings(table, context.run.axes);
  ForceObserverBlock observer;
  for (const auto& machine : settings.machine)
    observer.observers.emplace_back(machine, context.period, settings.slope_samples);
  Block block;
  block.inputs = ports<ForceObserverBlock::In::kCount>({{"displacement", kPerAxis, "m"},
                                                        {"acceleration", kPerAxis, "m/s2"},
                                                        {"force", kPerAxis, "N"}});
  block.outputs = ports<ForceObserverBlock::Out::kCount>(
      {{"force", kPerAxis, "N"}, {"velocity", kPerAxis, "m/s"}, {"machine_force", kPerAxis, "N"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  block.kind = std::move(observer);
  return block;
}

Block make_adaptive_inverse(const Config& table, const BlockContext& context) {
  AdaptiveInverseBlock block_kind{{}, Fade{context.period / kFadeTime}, context.period};
  for (const auto& settings :
       experiment::adaptive_inverse_settings(table, context.run.axes, context.period))
    block_kind.compensators.push_back(
        table.placed("name", [&] { return controller::AdaptiveInverse{settings}; }));
  Block block;
  block.inputs = ports<AdaptiveInverseBlock::In::kCount>({{"command", kPerAxis, "m"},
                                                          {"measured", kPerAxis, "m"},
                                                          {"force", kPerAxis, "N"},
                                                          {"lost_time", kSingle, "s", true},
                                                          {"is_force_ahead", kSingle, "1", true}});
  block.outputs = ports<AdaptiveInverseBlock::Out::kCount>({{"reference", kPerAxis, "m"},
                                                            {"a0", kPerAxis, "1"},
                                                            {"a1", kPerAxis, "s"},
                                                            {"a2", kPerAxis, "s2"},
                                                            {"a3", kPerAxis, ""},
                                                            {"load", kPerAxis, ""},
                                                            {"load_rate", kPerAxis, ""},
                                                            {"dead_band", kPerAxis, "m"},
                                                            {"flow_loss", kPerAxis, "s"},
                                                            {"learning", kPerAxis, "1"},
                                                            {"clipped", kPerAxis, "1"},
                                                            {"bad_samples", kPerAxis, "1"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = std::move(block_kind);
  return block;
}

Block make_table_force_observer(const Config& table, const BlockContext& context) {
  const auto settings =
      experiment::table_force_observer_settings(table, context.run.axes, context.period);
  TableForceObserverBlock observer;
  for (const auto& machine : settings.machine)
    observer.observers.push_back(table.placed("name", [&] {
      return controller::TableForceObserver{machine, settings.observer};
    }));
  Block block;
  block.inputs = ports<TableForceObserverBlock::In::kCount>({{"displacement", kPerAxis, "m"},
                                                             {"acceleration", kPerAxis, "m/s2"},
                                                             {"force", kPerAxis, "N"},
                                                             {"axial_load", kSingle, "N", true}});
  block.outputs = ports<TableForceObserverBlock::Out::kCount>({{"force", kPerAxis, "N"},
                                                               {"velocity", kPerAxis, "m/s"},
                                                               {"machine_force", kPerAxis, "N"},
                                                               {"bad_samples", kPerAxis, "1"},
                                                               {"displacement", kPerAxis, "m"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  block.kind = std::move(observer);
  return block;
}

Block make_target_force(const Config& table, const BlockContext& context) {
  const Config inputs = table.table_or_empty("in");
  const auto settings =
      experiment::target_force_settings(table, context.run.axes, context.period,
                                        context.run.simulation_step, context.run.specimen.get());
  for (const char* input : {"command", "command_velocity", "command_acceleration"})
    if (settings.lead_time > 0 && !inputs.has(input))
      table.fail("lead_time_s", std::string{"lead_time_s needs the input '"} + input + "'");
  Block block;
  block.inputs =
      ports<TargetForceBlock::In::kCount>({{"target", kPerAxis, "m"},
                                           {"displacement", kPerAxis, "m"},
                                           {"acceleration", kPerAxis, "m/s2"},
                                           {"force", kPerAxis, "N"},
                                           {"command", kPerAxis, "m", true},
                                           {"command_velocity", kPerAxis, "m/s", true},
                                           {"command_acceleration", kPerAxis, "m/s2", true},
                                           {"axial_load", kSingle, "N", true}});
  block.outputs = ports<TargetForceBlock::Out::kCount>({{"force", kPerAxis, "N"},
                                                        {"correction", kPerAxis, "N"},
                                                        {"strength", kSingle, "N"},
                                                        {"learning", kSingle, "1"},
                                                        {"bad_samples", kSingle, "1"},
                                                        {"ahead", kPerAxis, "N"},
                                                        {"is_ahead", kSingle, "1"}});
  add_parameter(block, table, "enabled", "1", 1, kOffOrOn);
  add_parameter(block, table, "adapt", "1", 1, kOffOrOn);
  block.kind = table.placed("name", [&] {
    return TargetForceBlock{controller::TargetForce{settings}, Fade{context.period / kFadeTime},
                            settings.lead_time > 0, inputs.has("axial_load")};
  });
  return block;
}

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
