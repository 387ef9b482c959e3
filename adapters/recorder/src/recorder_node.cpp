// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/recorder.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {

using namespace experiment;

namespace {

constexpr double kRowPeriod = 1e-3;  // [s]
constexpr double kOverhang = 0.2;    // recorded after the other nodes came to rest [s]

std::unique_ptr<Adapter> make(const Experiment& setup, const NodeContext& context) {
  RecorderSettings settings;
  settings.file = context.recording;
  settings.info = {context.config, context.meta, {}};
  for (const auto& [node, period] : context.periods)
    settings.info.steps_per_row[node] = to_seconds(context.period) / to_seconds(period);
  settings.own_thread = !context.is_virtual;
  settings.period = to_seconds(context.period);
  settings.linger = setup.stop.retreat.hold + setup.stop.retreat.ramp + kOverhang;
  settings.longest = setup.stop.longest + 2 * kOverhang;
  return make_recorder(context.map, settings);
}

}  // namespace

NodeSettings read_recorder(const std::string& /*node*/, const Config& /*table*/,
                           const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.role = Role::Recorder;
  settings.schedule = schedule_of(kRowPeriod, 0.8 * kRowPeriod);
  settings.monitors = recorder_monitors;
  settings.make = make;
  return settings;
}

}  // namespace rths::adapters
