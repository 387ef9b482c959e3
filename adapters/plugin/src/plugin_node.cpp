// SPDX-License-Identifier: Apache-2.0
#include <rths/plugin/plugin_node.hpp>

#include <array>

#include <fmt/format.h>

#include <rths/plugin/child_adapter.hpp>
#include <rths/plugin/plugin_adapter.hpp>
#include <rths/plugin/python_file.hpp>

namespace rths::plugin {
namespace {

using adapters::NodeContext;
using adapters::NodeSettings;
using adapters::Role;
using adapters::TestSetup;

/// A role of a plugin, with the schedule of the built-in adapters of this role [s].
struct PluginRole {
  const char* name;
  Role role;
  double period, phase;
  int priority;
};
constexpr std::array kRoles{PluginRole{"machine", Role::Machine, 1e-3, 0, 60},
                            PluginRole{"controller", Role::Controller, 1e-3, 0.3e-3, 50},
                            PluginRole{"solver", Role::Solver, 0.25e-3, 0.1e-3, 40}};
// Of a step. Peers of a node in real time wait for 0.5 s. In virtual time nobody waits, and the
// host may be busy.
constexpr double kStepDeadline = 0.3, kStepDeadlineInVirtualTime = 5;  // [s]
constexpr double kChildMargin = 0.1;  // for the answer of the process [s]

const PluginRole& read_role(const Config& table) {
  const std::string name = table.text("role");
  for (const auto& role : kRoles)
    if (role.name == name) return role;
  table.fail("role", fmt::format("role is '{}', expected machine, controller or solver", name));
}

std::unique_ptr<adapters::Adapter> make(PluginSettings plugin, bool own_process, double deadline,
                                        int priority, const TestSetup& setup,
                                        const NodeContext& context) {
  plugin.retreat = setup.retreat;
  plugin.step_deadline =
      deadline > 0 ? deadline : (context.is_virtual ? kStepDeadlineInVirtualTime : kStepDeadline);
  if (!own_process) return make_plugin(plugin);
  ChildSettings child;
  child.title = plugin.title.empty() ? fmt::format("plugin of node '{}' ({})", context.node,
                                                   plugin.library.filename().string())
                                     : plugin.title;
  child.step_deadline = plugin.step_deadline + kChildMargin;
  child.priority = context.is_virtual ? 0 : priority;
  return make_child([plugin] { return make_plugin(plugin); }, child);
}

}  // namespace

NodeSettings read_plugin(const std::string& /*node*/, const Config& table,
                         const TestSetup& /*setup*/) {
  const PluginRole& role = read_role(table);
  const auto file = table.resolve(table.text("library"));
  if (!std::filesystem::exists(file))
    table.fail("library", fmt::format("library is '{}', expected a file", file.string()));
  const std::string config = table.table_or_empty("config").to_toml();
  const auto found = table.placed("library", [&] { return plugin_file(file, config); });
  PluginSettings plugin;
  plugin.library = found.library;
  plugin.config = found.config;
  plugin.title = found.title;
  // An interpreter uses the heap, and a jump out of it would leave it in a bad state.
  plugin.may_allocate = table.flag("allocates", found.is_python) || found.is_python;
  const bool own_process = table.flag("own_process", found.is_python) || found.is_python;
  const double deadline = table.number_in("deadline_s", 0, 100, 0.0);
  NodeSettings settings;
  settings.role = role.role;
  settings.schedule = adapters::schedule_of(role.period, role.phase);
  settings.priority = role.priority;
  settings.keeps_times = role.role != Role::Solver;
  settings.make = [=, priority = role.priority](const TestSetup& setup,
                                                const NodeContext& context) {
    return make(plugin, own_process, deadline, priority, setup, context);
  };
  return settings;
}

}  // namespace rths::plugin
