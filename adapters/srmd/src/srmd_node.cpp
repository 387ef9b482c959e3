// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/srmd.hpp>

#include <string>
#include <vector>

#include <rths/core/installed_files.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {

using namespace experiment;

namespace {

constexpr double kPeriod = 1e-3;  // [s]

std::unique_ptr<Adapter> make(const Experiment& setup, const NodeContext& context) {
  SrmdSettings settings;
  settings.machine = setup.machine.simulated;
  settings.period = to_seconds(context.period);
  settings.axes = setup.axes;
  settings.retreat = setup.stop.retreat;
  return make_srmd(settings);
}

// A machine file with the changes of the experiment, and the member of its family.
sim::machine::FamilyMember read_member(const Config& table, NodeSettings& settings) {
  const Config file =
      Config::load(find_file(table, "model", "machines")).overlaid(table.table_or_empty("changes"));
  settings.schedule.missed = read_late_inputs(file, "due", MissedSteps::Wait);
  const auto nominal = sim::machine::read_platen_machine(file.without("late_inputs"));
  const auto index = table.integer_in("family_member", 0, sim::machine::kFamilySize, 0);
  return sim::machine::family_member(nominal, static_cast<int>(index));
}

std::unique_ptr<Adapter> make_platen(const sim::machine::FamilyMember& member,
                                     const Experiment& setup, const NodeContext& context) {
  SrmdPlatenSettings settings;
  settings.machine = member.machine;
  settings.machine.has_specimen = setup.machine.simulated.has_specimen;
  settings.machine.has_rollers = setup.machine.simulated.has_rollers;
  settings.machine.specimen =
      sim::machine::with_stiffness(setup.specimen, member.specimen_stiffness);
  settings.machine.seed = setup.machine.simulated.seed;
  settings.period = to_seconds(context.period);
  settings.axes = setup.axes;
  settings.retreat = setup.stop.retreat;
  return make_srmd_platen(settings);
}

}  // namespace

// The machine samples before the controller steps.
NodeSettings read_srmd(const std::string& /*node*/, const Config& table,
                       const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0);
  settings.priority = 60;
  settings.keeps_times = true;
  settings.machine_table = MachineTable::Whole;
  settings.make = make;
  if (!table.has("model"))
    settings.schedule.missed = read_late_inputs(table, "due", MissedSteps::Wait);
  if (table.has("model")) {
    settings.machine_table = MachineTable::Carriage;
    settings.make = [member = read_member(table, settings)](const Experiment& test,
                                                            const NodeContext& context) {
      return test.machine.is_identified ? make(test, context) : make_platen(member, test, context);
    };
  }
  return settings;
}

NodeSettings read_ideal_machine(const std::string& /*node*/, const Config& /*table*/,
                                const Experiment& /*setup*/) {
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod, MissedSteps::Wait);
  settings.make = [](const Experiment& setup, const NodeContext&) {
    return make_ideal_machine(
        {setup.specimen, setup.axes, setup.time.integration_step, setup.time.simulation_step()});
  };
  return settings;
}

}  // namespace rths::adapters
