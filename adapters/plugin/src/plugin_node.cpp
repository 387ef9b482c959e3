// SPDX-License-Identifier: Apache-2.0
#include <rths/plugin/plugin_node.hpp>

#include <array>
#include <utility>

#include <fmt/format.h>

#include <rths/core/file.hpp>
#include <rths/core/sha256.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/plugin/child_adapter.hpp>
#include <rths/plugin/library.hpp>

namespace rths::plugin {
namespace {

using namespace experiment;

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
// A solver may begin after the rest of the test.
constexpr double kLongestUnset = 2;                                    // [s]
constexpr double kStepDeadline = 0.3, kStepDeadlineInVirtualTime = 5;  // [s]

const PluginRole& role_in(const Config& table) {
  const std::string name = table.text("role");
  for (const auto& role : kRoles)
    if (role.name == name) return role;
  table.fail("role", fmt::format("role is '{}', expected machine, controller or solver", name));
}

}  // namespace

NodeSettings read_role(const Config& table) {
  const PluginRole& role = role_in(table);
  NodeSettings settings;
  settings.role = role.role;
  settings.schedule = schedule_of(role.period, role.phase);
  if (role.role == Role::Controller) settings.schedule.missed = MissedSteps::MakeDue;
  if (role.role == Role::Machine)
    settings.schedule.missed = experiment::read_late_inputs(table, "newest", MissedSteps::MakeDue);
  settings.priority = role.priority;
  settings.keeps_times = role.role != Role::Solver;
  settings.solver.may_not_end = role.role == Role::Solver;
  if (role.role == Role::Machine) settings.machine_table = experiment::MachineTable::Model;
  return settings;
}

Hosting read_hosting(const Config& table) {
  Hosting hosting;
  hosting.own_process = table.flag("own_process", false);
  hosting.step_deadline = table.number_in("deadline_s", 0, 100, 0.0);
  hosting.may_allocate = table.flag("allocates", false);
  hosting.priority = role_in(table).priority;
  return hosting;
}

std::unique_ptr<adapters::Adapter> make_hosted(PluginSettings plugin, const Hosting& hosting,
                                               const Experiment& setup,
                                               const NodeContext& context) {
  plugin.retreat = setup.stop.retreat;
  plugin.may_allocate = hosting.may_allocate;
  plugin.step_deadline = hosting.step_deadline;
  if (plugin.step_deadline == 0)
    plugin.step_deadline = context.is_virtual ? kStepDeadlineInVirtualTime : kStepDeadline;
  plugin.longest_unset = setup.time.rest + kLongestUnset;
  if (!hosting.own_process) return make_plugin(plugin);
  ChildSettings child;
  child.title = plugin.title;
  if (child.title.empty())
    child.title =
        fmt::format("{} of node '{}' ({})", plugin.built_in ? plugin.built_in->name : "plugin",
                    context.node, plugin.library.filename().string());
  child.step_deadline = plugin.step_deadline;
  child.priority = context.is_virtual ? 0 : hosting.priority;
  return make_child([plugin] { return make_plugin(plugin); }, child);
}

Config identity_of(const std::filesystem::path& file) {
  Config identity;
  identity.put("file", file.filename().string());
  identity.put("size_bytes", static_cast<double>(std::filesystem::file_size(file)));
  identity.put("sha256", sha256_of(file));
  return identity;
}

NodeSettings read_plugin(const std::string& node, const Config& table,
                         const Experiment& /*setup*/) {
  NodeSettings settings = read_role(table);
  const auto file = table.resolve(table.text("library"));
  if (!std::filesystem::exists(file))
    table.fail("library", fmt::format("library is '{}', expected a file", file.string()));
  const std::string config = table.table_or_empty("config").to_toml();
  const auto found = table.placed("library", [&] { return plugin_file(file, config); });
  Hosting hosting = read_hosting(table);
  // An interpreter uses the heap, and a jump out of it would leave it in a bad state.
  if (found.is_python) hosting.may_allocate = hosting.own_process = true;
  settings.texts = [file, node, is_python = found.is_python] {
    std::vector<std::pair<std::string, std::string>> texts{
        {node + ".plugin", identity_of(file).to_toml()}};
    if (is_python) texts.emplace_back(file.filename().string(), read_file(file, kMostTextBytes));
    return texts;
  };
  PluginSettings plugin;
  plugin.library = found.library;
  plugin.config = found.config;
  plugin.title = found.title;
  settings.make = [=](const Experiment& test, const NodeContext& context) {
    return make_hosted(plugin, hosting, test, context);
  };
  return settings;
}

}  // namespace rths::plugin
