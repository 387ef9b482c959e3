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

}  // namespace rths::adapters
