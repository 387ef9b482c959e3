// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd_node.hpp>

#include <rths/adapters/ideal_machine.hpp>
#include <rths/adapters/safety_node.hpp>
#include <rths/adapters/srmd.hpp>

namespace rths::adapters {
namespace {

constexpr double kPeriod = 1e-3;  // [s]

std::unique_ptr<Adapter> make(const TestSetup& setup, const NodeContext& context) {
  SrmdSettings settings;
  settings.machine = setup.machine;
  settings.period = to_seconds(context.period);
  settings.axes = setup.axes;
  settings.retreat = setup.retreat;
  return make_srmd(settings);
}

}  // namespace

// The machine samples before the controller steps.
NodeSettings read_srmd(const std::string& /*node*/, const Config& table, const TestSetup& setup) {
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0);
  settings.priority = 60;
  settings.keeps_times = true;
  settings.make = make;
  return with_safety(std::move(settings), table.table_or_empty("safety"), setup);
}

NodeSettings read_ideal_machine(const std::string& /*node*/, const Config& /*table*/,
                                const TestSetup& /*setup*/) {
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod);
  settings.make = [](const TestSetup& setup, const NodeContext&) {
    return make_ideal_machine(
        {setup.specimen, setup.axes, setup.integration_step, setup.simulation_step()});
  };
  return settings;
}

}  // namespace rths::adapters
