// SPDX-License-Identifier: Apache-2.0
//
// Builds the blocks of adaptive inverse, table force observer and target force from [[block]]
// tables.
#include <rths/experiment/block_settings.hpp>

#include "block_tables.hpp"

namespace rths::adapters {

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

}  // namespace rths::adapters
