// SPDX-License-Identifier: Apache-2.0
//
// The composition root: the only place that knows the adapters by name.
#include <rths/app/builtin_adapters.hpp>

#include <rths/adapters/echo.hpp>
#include <rths/adapters/external_node.hpp>
#include <rths/adapters/numerical.hpp>
#include <rths/adapters/opensees.hpp>
#include <rths/adapters/opensees_specimen.hpp>
#include <rths/adapters/recorder.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/adapters/srmd.hpp>
#include <rths/fmi/fmu_node.hpp>
#include <rths/plugin/plugin_node.hpp>

namespace rths::app {
namespace {

using experiment::Experiment;
using experiment::NodeContext;
using experiment::NodeSettings;

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
    {"srmd", adapters::read_srmd},
    {"ideal_machine", adapters::read_ideal_machine},
    {"echo", adapters::read_echo},
    {"opensees_specimen", adapters::read_opensees_specimen_node},
    {"simulink_like", adapters::read_simulink_like},
    {"numerical", adapters::read_numerical},
    {"opensees", read_opensees},
    {"external", read_external},
    {"plugin", plugin::read_plugin},
    {"fmu", fmi::read_fmu},
};

}  // namespace

std::span<const experiment::AdapterKind> builtin_adapters() { return kAdapters; }

}  // namespace rths::app
