// SPDX-License-Identifier: Apache-2.0
//
// The composition root: the only place that knows the adapters by name.
#include <rths/app/builtin_adapters.hpp>

#include <utility>

#include <rths/adapters/echo.hpp>
#include <rths/adapters/external_node.hpp>
#include <rths/adapters/numerical.hpp>
#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/adapters/recorder.hpp>
#include <rths/adapters/replay.hpp>
#include <rths/adapters/safe_machine.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/fmi/fmu_node.hpp>
#include <rths/plugin/plugin_node.hpp>

namespace rths::app {
namespace {

using experiment::Experiment;
using experiment::NodeContext;
using experiment::NodeSettings;

// The words of the axes that the safety layer guards: the tested ones, and the vertical one of a
// machine that moves it.
std::vector<adapters::MachineAxis> words_of(const Experiment& setup, bool drives_vertical) {
  std::vector<adapters::MachineAxis> words;
  for (const std::string& axis : names_of(kTranslations)) {
    if (contains(setup.axes, axis) || (drives_vertical && axis == name_of(Axis::Vert)))
      words.push_back({axis, "xpc." + axis + ".displ.ref", "srmd." + axis + ".displ.fbk",
                       "srmd." + axis + ".force.fbk"});
  }
  return words;
}

NodeSettings read_srmd(const std::string& node, const Config& table, const Experiment& setup) {
  NodeSettings settings = adapters::read_srmd(node, table, setup);
  return adapters::with_safety(std::move(settings), table.table_or_empty("safety"), setup,
                               words_of(setup, table.has("model")));
}

// A machine of the user's own has the safety layer if its table has `safety`.
template <auto read>
NodeSettings read_guarded(const std::string& node, const Config& table, const Experiment& setup) {
  NodeSettings settings = read(node, table, setup);
  settings.lacks_safety = settings.role == experiment::Role::Machine && !table.has("safety");
  if (settings.role != experiment::Role::Machine || settings.lacks_safety) return settings;
  return adapters::with_safety(std::move(settings), table.table("safety"), setup);
}

// A given history needs no OpenSees: the project's own solver imposes it.
NodeSettings read_opensees(const std::string& node, const Config& table, const Experiment& setup) {
  NodeSettings settings = adapters::read_opensees_node(
      node, table, setup, adapters::read_ideal_machine(node, {}, setup));
  settings.make = [make = settings.make, handshake = adapters::read_handshake(table)](
                      const Experiment& test, const NodeContext& context) {
    return test.history ? adapters::make_numerical_node(test, context, handshake)
                        : make(test, context);
  };
  return settings;
}

// Nor does it need a user's own solver.
NodeSettings read_external(const std::string& node, const Config& table, const Experiment& setup) {
  NodeSettings settings = adapters::read_external(node, table, setup);
  const NodeSettings solver = adapters::read_numerical(node, Config{}, setup);
  settings.make = solver.make;
  settings.schedule = solver.schedule;
  settings.solver.has_computing_time = settings.solver.waits_for_flags = true;
  settings.machine_table = experiment::MachineTable::Model;
  return settings;
}

constexpr experiment::AdapterKind kAdapters[] = {
    {"recorder", adapters::read_recorder},
    {"srmd", read_srmd},
    {"ideal_machine", adapters::read_ideal_machine},
    {"echo", adapters::read_echo},
    {"opensees_specimen", adapters::read_opensees_specimen_node},
    {"simulink_like", adapters::read_simulink_like},
    {"numerical", adapters::read_numerical},
    {"opensees", read_opensees},
    {"external", read_external},
    {"plugin", read_guarded<plugin::read_plugin>},
    {"fmu", read_guarded<fmi::read_fmu>},
    {"replay", adapters::read_replay},
};

}  // namespace

std::span<const experiment::AdapterKind> builtin_adapters() { return kAdapters; }

}  // namespace rths::app
